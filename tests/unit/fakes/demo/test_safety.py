"""A demo begins with devices that nothing has happened to, and never touches real ones."""

from pathlib import Path

import pytest

from fakes.demo.safety import NotSimulated, as_drawn

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


def kept(cell: Path) -> list[str]:
    return sorted(path.name for path in (cell.parent / "calibration").iterdir())


def test_what_an_earlier_fake_cell_suffered_is_undone(cell: Path) -> None:
    as_drawn(cell)
    assert kept(cell) == ["payload.json"]


@pytest.mark.parametrize("device", ["robots.main", "force_sensors.force.stop_channel"])
def test_one_real_device_is_enough_to_refuse(cell: Path, device: str) -> None:
    before, after = SIMULATED.split(f"[{device}]")
    cell.write_text(f"{before}[{device}]{after.replace('simulated = true', '', 1)}")
    with pytest.raises(NotSimulated, match=device):
        as_drawn(cell)
    assert kept(cell) == ["payload.invalidated.json", "payload.json"]


def test_the_template_of_a_real_cell_is_refused() -> None:
    with pytest.raises(NotSimulated, match=r"robots\.main, robots\.aux_1"):
        as_drawn(Path(__file__).parents[4] / "config" / "cell.toml")


def test_without_any_device_nothing_is_deleted(cell: Path) -> None:
    cell.write_text('calibration_dir = "calibration"')
    as_drawn(cell)
    assert len(kept(cell)) == 2


def test_keys_of_processes_are_no_devices(cell: Path) -> None:
    cell.write_text(f'{SIMULATED}\n[processes.screwing]\ndriver = "bit"\n')
    as_drawn(cell)
    assert kept(cell) == ["payload.json"]


@pytest.mark.parametrize("content", [None, "= broken", "name = 1"])
def test_a_cell_file_that_is_wrong_is_left_to_the_daemon(
    tmp_path: Path, content: str | None
) -> None:
    cell = tmp_path / "cell.toml"
    if content is not None:
        cell.write_text(content)
    as_drawn(cell)
