"""The programs of a demonstration."""

from pathlib import Path

import pytest

from fakes.demo.children import Child


def test_their_modules_are_not_those_of_the_folder_in_which_one_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # As in the folder above a clone, which is called cellctl itself.
    (tmp_path / "cellctl").mkdir()
    monkeypatch.chdir(tmp_path)
    child = Child.start("version", ["-c", "import cellctl.version"], tmp_path / "log")
    assert child.process.wait(60) == 0, child.log.read_text()
