"""The programs of a demonstration."""

import os
from pathlib import Path

import pytest

from fakes.demo.children import Child, ChildFailed


def test_their_modules_are_not_those_of_the_folder_in_which_one_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # As in the folder above a clone, which is called cellctl itself.
    (tmp_path / "cellctl").mkdir()
    monkeypatch.chdir(tmp_path)
    child = Child.start("version", ["-c", "import cellctl.version"], tmp_path / "log")
    assert child.process.wait(60) == 0, child.log.read_text()


@pytest.mark.parametrize(("load", "crowded"), [(0.5, False), (1000.0, True)])
def test_a_late_start_names_its_log_and_a_computer_that_is_too_busy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, load: float, crowded: bool
) -> None:
    monkeypatch.setattr(os, "getloadavg", lambda: (load, load, load))
    child = Child.start("late", ["-c", "import time; time.sleep(60)"], tmp_path / "log")
    try:
        with pytest.raises(ChildFailed, match=r"late is not ready after 0 s; its log is ") as late:
            child.wait_ready(0.01)
    finally:
        child.process.kill()
        child.process.wait()
    assert ("this computer was too slow: " in str(late.value)) is crowded
