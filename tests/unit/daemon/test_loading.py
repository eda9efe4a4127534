"""What the daemon loads before it is ready."""

import subprocess
import sys

import pytest

LOADED = """
import importlib, pkgutil, re, sys
import cellctl.daemon.app, cellctl.processes
pattern, *heavy = sys.argv[1:]
for module in pkgutil.walk_packages(cellctl.processes.__path__, "cellctl.processes."):
    if re.search(pattern, module.name):
        importlib.import_module(module.name)
        print("loaded", module.name)
print(sorted(set(heavy) & set(sys.modules)))
"""


@pytest.mark.parametrize(
    ("pattern", "heavy"),
    [
        # Drawing alone was a quarter of the start.
        pytest.param(r"\.procedures\.", ("matplotlib", "weasyprint"), marks=pytest.mark.figures),
        (r"deck_to_frame\.(process$|procedures\.)", ("scipy.optimize", "scipy.stats")),
    ],
    ids=["drawing", "solving"],
)
def test_what_only_workers_need_is_left_to_them(pattern: str, heavy: tuple[str, ...]) -> None:
    command = [sys.executable, "-c", LOADED, pattern, *heavy]
    ran = subprocess.run(command, capture_output=True, text=True, check=True)
    *loaded, found = ran.stdout.splitlines()
    assert len(loaded) > 3, "else the test shows nothing"
    assert found == "[]"
