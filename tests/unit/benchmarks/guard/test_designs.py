"""The guard process of the benchmark is found from any folder, as a guard looks for its modules."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.guard.designs import GUARD_MODULE, show_benchmarks_to_programs

FIND = "import importlib.util, sys; sys.exit(importlib.util.find_spec(sys.argv[1]) is None)"


def test_a_guard_finds_the_module_of_the_benchmark(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "environ", dict(os.environ))
    show_benchmarks_to_programs()
    look = [sys.executable, "-P", "-c", FIND, GUARD_MODULE]
    subprocess.run(look, check=True, cwd=tmp_path, env=os.environ)
