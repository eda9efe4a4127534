"""A demo begins with devices that nothing has happened to, and never touches real ones."""

from pathlib import Path

import pytest

from fakes.demo.safety import FolderInUse, NotSimulated, own_calibrations, require_own_folder

SIMULATED = """
calibration_dir = "calibration"

[robots.main]
driver = "siasun-sjl"
simulated = true

[force_sensors.force]
driver = "sri"
simulated = true

[force_sensors.force.stop_channel]
driver = "siasun-sjl"
simulated = true
"""


Tree = dict[str, bytes]


def tree(folder: Path) -> Tree:
    """Every file below a folder."""
    files = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


@pytest.fixture
def cell(tmp_path: Path) -> Path:
    """A cell file with a calibration that was invalidated."""
    folder = tmp_path / "calibration"
    folder.mkdir()
    (folder / "payload.json").write_text("{}")
    (folder / "payload.invalidated.json").write_text("{}")
    file = tmp_path / "cell.toml"
    file.write_text(SIMULATED)
    return file


def test_a_demo_works_on_a_copy_of_devices_to_which_nothing_has_happened(
    cell: Path, tmp_path: Path
) -> None:
    before = tree(cell.parent)
    copy = own_calibrations(cell, tmp_path / "run")
    assert copy is not None
    assert sorted(tree(copy)) == ["payload.json"], "no note of what an earlier fake cell suffered"
    assert {name: data for name, data in tree(cell.parent).items() if name[:3] != "run"} == before
    (copy / "payload.json").write_text("made anew")
    assert tree(cell.parent)["calibration/payload.json"] == before["calibration/payload.json"]


@pytest.mark.parametrize("device", ["robots.main", "force_sensors.force.stop_channel"])
def test_one_real_device_is_enough_to_refuse(cell: Path, device: str, tmp_path: Path) -> None:
    before, after = SIMULATED.split(f"[{device}]")
    cell.write_text(f"{before}[{device}]{after.replace('simulated = true', '', 1)}")
    there = tree(tmp_path)
    with pytest.raises(NotSimulated, match=device):
        own_calibrations(cell, tmp_path / "run")
    assert tree(tmp_path) == there


def test_the_template_of_a_real_cell_is_refused(tmp_path: Path) -> None:
    with pytest.raises(NotSimulated, match=r"robots\.main, robots\.aux_1"):
        own_calibrations(Path(__file__).parents[4] / "config" / "cell.toml", tmp_path)
    assert tree(tmp_path) == {}


def test_without_any_device_nothing_is_copied(cell: Path, tmp_path: Path) -> None:
    cell.write_text('calibration_dir = "calibration"')
    assert own_calibrations(cell, tmp_path / "run") is None
    assert not (tmp_path / "run").exists()


def test_keys_of_processes_are_no_devices(cell: Path, tmp_path: Path) -> None:
    cell.write_text(f'{SIMULATED}\n[processes.screwing]\ndriver = "bit"\n')
    assert own_calibrations(cell, tmp_path / "run") is not None


@pytest.mark.parametrize("content", [None, "= broken", "name = 1"])
def test_a_cell_file_that_is_wrong_is_left_to_the_daemon(
    tmp_path: Path, content: str | None
) -> None:
    cell = tmp_path / "cell.toml"
    if content is not None:
        cell.write_text(content)
    assert own_calibrations(cell, tmp_path / "run") is None


def test_a_cell_without_calibrations_makes_its_own(cell: Path, tmp_path: Path) -> None:
    cell.write_text(SIMULATED.replace('"calibration"', '"none-yet"'))
    copy = own_calibrations(cell, tmp_path / "run")
    assert copy is not None
    assert tree(copy) == {}


def test_a_folder_that_no_demo_has_made_is_not_written(tmp_path: Path) -> None:
    (tmp_path / "store").mkdir()
    (tmp_path / "store" / "store.sqlite").write_text("runs of a real cell")
    with pytest.raises(FolderInUse, match="choose another"):
        require_own_folder(tmp_path)


def test_an_empty_folder_and_that_of_an_earlier_demo_may_be_written(tmp_path: Path) -> None:
    require_own_folder(tmp_path)
    require_own_folder(tmp_path / "new")
    (tmp_path / "fake-cell.log").write_text("")
    require_own_folder(tmp_path)
