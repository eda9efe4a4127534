"""A demo begins with devices that nothing has happened to."""

from pathlib import Path

import pytest

from fakes.demo.app import _as_calibrated


def test_what_an_earlier_fake_cell_suffered_is_undone(tmp_path: Path) -> None:
    cell = tmp_path / "cell.toml"
    cell.write_text('calibration_dir = "calibration"')
    folder = tmp_path / "calibration"
    folder.mkdir()
    (folder / "payload.json").write_text("{}")
    (folder / "payload.invalidated.json").write_text("{}")
    _as_calibrated(cell)
    assert [path.name for path in folder.iterdir()] == ["payload.json"]


@pytest.mark.parametrize("content", [None, "= broken", "name = 1"])
def test_a_cell_file_that_is_wrong_is_left_to_the_daemon(
    tmp_path: Path, content: str | None
) -> None:
    cell = tmp_path / "cell.toml"
    if content is not None:
        cell.write_text(content)
    _as_calibrated(cell)
