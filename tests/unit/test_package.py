"""``python -m cellctl`` tells an older Python what it needs."""

import ast
import runpy
import sys
from pathlib import Path

import pytest

import cellctl


def test_an_older_python_gets_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "version_info", (3, 10, 13, "final", 0))
    with pytest.raises(SystemExit) as ended:
        runpy.run_path(cellctl.__file__)
    assert ended.value.code == "cellctl needs Python 3.11 or newer; this is Python 3.10."


def test_an_older_python_can_read_that_far() -> None:
    """A newer notation would end in a SyntaxError before the sentence."""
    ast.parse(Path(cellctl.__file__).read_text(encoding="ascii"), feature_version=(3, 6))
