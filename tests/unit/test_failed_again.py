"""What has failed beside other tests is tried once more, alone, and only if it is a few."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SECOND = "--last-failed", "--last-failed-no-failures", "none", "--most-again", "2"
FLAKY = """
from pathlib import Path
import pytest

@pytest.mark.parametrize("k", range(6))
def test_it(k):
    tried = Path(__file__).with_name(f"tried-{k}")
    first = not tried.exists()
    tried.touch()
    assert not (k < FAILING and (first or ALWAYS))
"""


def run(folder: Path, *options: str) -> subprocess.CompletedProcess[str]:
    # Plug-ins that are not asked here cost each of the many calls a second.
    plugins = "-p", "tests.failed_again", "-p", "xdist"
    command = [sys.executable, "-m", "pytest", *plugins, "-c", "/dev/null"]
    return subprocess.run(
        [*command, "--rootdir", str(folder), *options, str(folder / "test_it.py")],
        check=False,
        capture_output=True,
        text=True,
        cwd=Path(__file__).parents[2],
        env=os.environ | {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
    )


def write(folder: Path, *, failing: int, always: bool = False) -> None:
    text = FLAKY.replace("FAILING", str(failing)).replace("ALWAYS", str(always))
    (folder / "test_it.py").write_text(text)


def test_a_few_that_pass_alone_are_named(tmp_path: Path) -> None:
    write(tmp_path, failing=2)
    assert run(tmp_path, "-n", "2").returncode == 1
    second = run(tmp_path, *SECOND)
    assert second.returncode == 0, second.stdout
    assert "2 passed" in second.stdout
    assert "TRIED AGAIN test_it.py::test_it[0]: passed alone" in second.stdout


def test_what_fails_again_counts(tmp_path: Path) -> None:
    write(tmp_path, failing=1, always=True)
    assert run(tmp_path).returncode == 1
    assert run(tmp_path, *SECOND).returncode == 1


@pytest.mark.figures  # two more runs of pytest
def test_many_are_not_tried_again(tmp_path: Path) -> None:
    write(tmp_path, failing=3)
    assert run(tmp_path).returncode == 1
    second = run(tmp_path, *SECOND)
    assert second.returncode == 1
    assert "3 tests have failed, which is too many to try again" in second.stdout


@pytest.mark.figures  # two more runs of pytest
def test_a_run_that_broke_without_a_failed_test_stays_failed(tmp_path: Path) -> None:
    write(tmp_path, failing=0)
    assert run(tmp_path).returncode == 0
    assert run(tmp_path, *SECOND).returncode != 0
