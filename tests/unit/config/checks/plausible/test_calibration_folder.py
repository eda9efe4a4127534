"""A folder of calibrations that belongs to another cell, or to another part."""

import shutil
from pathlib import Path

import pytest

from cellctl.config import problems, problems_before_commissioning
from cellctl.config.process_definition import installed_processes, process_definition
from cellctl.runtime.process import Process
from tests.unit.config.test_mistakes import CONFIG, written


def in_folder(tmp_path: Path, file: str, own: str, other: str) -> str:
    """What is said of a cell file that names another folder than its own; empty for nothing."""
    path = written(tmp_path, file, f'"{own}"', f'"{other}"')
    assert problems(path) == []  # a daemon that has worked in it must start
    found = [one for one in problems_before_commissioning(path) if one.key == "calibration_dir"]
    assert all(one.line is not None and one.value == repr(other) for one in found)
    return found[0].allowed if found else ""


@pytest.mark.parametrize("other", ["antenna-calibration", "insertion-pin-calibration"])
def test_calibrations_of_devices_that_the_cell_lacks_are_refused(
    tmp_path: Path, other: str
) -> None:
    said = in_folder(tmp_path, "deck.toml", "demo-calibration", other)
    assert "head_1, head_2, base_frame, board_transfer, ... of this cell" in said
    stored = "base_T_cam2" if other.startswith("antenna") else "contact_loop_1"
    assert f"has none of them, and has {stored}" in said
    assert said.endswith("did you mean 'demo-calibration'?")


def test_a_folder_that_is_empty_or_missing_is_that_of_a_new_cell(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir(parents=True)
    assert in_folder(tmp_path, "deck.toml", "demo-calibration", "empty") == ""
    shutil.rmtree(tmp_path / "features")
    for linked in tmp_path.iterdir():
        if linked.is_symlink():
            linked.unlink()
    assert in_folder(tmp_path, "deck.toml", "demo-calibration", "not-there") == ""


@pytest.mark.parametrize(
    ("file", "old", "new", "key"),
    [
        ("antenna.toml", "views = 30", "views = 3", "processes.antenna-module.views"),
        ("deck.toml", "square_mm = 25.0", 'square_mm = "25"', "processes.deck-to-frame.square_mm"),
        ("small.toml", "port = ", "prot = ", ""),
    ],
)
def test_a_section_that_is_wrong_itself_has_one_error(
    tmp_path: Path, file: str, old: str, new: str, key: str
) -> None:
    """Nobody knows what its process stores, and its own folder is no other cell's."""
    found = [one.key for one in problems_before_commissioning(written(tmp_path, file, old, new))]
    assert "calibration_dir" not in found
    assert not key or found == [key]


def test_one_of_its_own_calibrations_is_enough(tmp_path: Path) -> None:
    (tmp_path / "begun").mkdir(parents=True)
    for name in ("demo-calibration/head_1", "antenna-calibration/camera_1"):
        shutil.copy(CONFIG / f"{name}.json", tmp_path / "begun")
    assert in_folder(tmp_path, "deck.toml", "demo-calibration", "begun") == ""


def test_the_loop_of_another_part_is_refused(tmp_path: Path) -> None:
    shutil.copytree(CONFIG, tmp_path, dirs_exist_ok=True)
    path = tmp_path / "insertion-pin.toml"
    path.write_text(path.read_text().replace('"insertion-pin-cal', '"insertion-connector-cal'))
    (found,) = problems_before_commissioning(path)
    assert found.key == "calibration_dir"
    assert "another folder than that of insertion-connector.toml: contact_loop_1" in found.allowed
    assert "'circular connector, shell size 23' there" in found.allowed
    assert "'precision pin 6 mm' here" in found.allowed
    assert found.allowed.endswith("did you mean 'insertion-pin-calibration'?")


def test_an_older_copy_of_the_file_is_named_as_what_may_be_in_the_way(tmp_path: Path) -> None:
    path = written(tmp_path, "insertion-pin.toml", 'name = "precision pin', 'name = "renamed pin')
    shutil.copy(CONFIG / "insertion-pin.toml", tmp_path / "insertion-pin-old.toml")
    found = [one.allowed for one in problems_before_commissioning(path)]
    assert any(
        "or take insertion-pin-old.toml away, if it is an older copy of this one" in allowed
        for allowed in found
    )


def test_two_files_of_one_part_may_share_a_folder() -> None:
    for name in ("antenna-rpc.toml", "deck-jobs.toml"):
        assert problems_before_commissioning(CONFIG / name) == [], name


def test_a_file_beside_it_that_cannot_be_read_is_no_matter(tmp_path: Path) -> None:
    path = written(tmp_path, "insertion-pin.toml")
    (tmp_path / "old.toml").write_text('calibration_dir = "insertion-pin-calibration"\nid = \n')
    (tmp_path / "new.toml").write_text('calibration_dir = "insertion-pin-calibration"\nrecipes = 1')
    assert problems_before_commissioning(path) == []


def test_processes_name_the_calibrations_that_they_store() -> None:
    for name in installed_processes():
        process = process_definition(name)
        if issubclass(process, Process) and process.calibration_kinds():
            assert process.stores == tuple(kind.name for kind in process.calibration_kinds()), name
