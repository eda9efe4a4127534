"""A cell before its first calibrations: what its file says against itself, and what is left."""

import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.cli.commands import whole_app
from cellctl.config.commissioning import examine_before_commissioning
from tests.unit.config.test_mistakes import written

STORED, NONE = 'calibration_dir = "antenna-calibration"', 'calibration_dir = "none-yet"'
CAMERA = "cameras.camera_1.flange_T_camera"
PLUG = "robots.arm.poses_deg.inspect_plug"


@pytest.fixture
def new(tmp_path: Path) -> Path:
    return written(tmp_path / "cell", "antenna.toml", STORED, NONE)


@pytest.mark.parametrize(
    ("old", "new_text", "key", "said"),
    [
        ("[110.0, 0.0, -50.0,", "[110.0, 0.0, 50.0,", CAMERA, "160 mm from what tray_look sees"),
        ("inspect_plug = [11.3", "inspect_plug = [-11.3", PLUG, "200 mm beside"),
        ("board_show = [11.3", "board_show = [-11.3", PLUG, "200 mm beside"),
        ("flange_T_board_mm = 205.0", "flange_T_board_mm = 155.0", PLUG, "50 mm above or below"),
    ],
)
def test_looks_that_contradict_each_other_are_remarks(
    new: Path, old: str, new_text: str, key: str, said: str
) -> None:
    text = new.read_text(encoding="utf-8")
    assert old in text
    new.write_text(text.replace(old, new_text), encoding="utf-8")
    examined = examine_before_commissioning(new)
    assert examined.errors == ()
    (remark,) = [one for one in examined.remarks if one.key == key]
    assert said in remark.allowed


def test_a_new_cell_is_told_what_nothing_contradicts_yet(new: Path, tmp_path: Path) -> None:
    done = CliRunner().invoke(whole_app(), ["check", str(new)])
    assert done.exit_code == 0
    for procedure in (201, 202, 203, 204):
        assert f"procedure {procedure}" in done.stdout
    assert examine_before_commissioning(new).remarks == ()
    calibrated = written(tmp_path / "calibrated", "antenna.toml")
    done = CliRunner().invoke(whole_app(), ["check", str(calibrated)])
    left = [line for line in done.stdout.splitlines() if "not checked yet" in line]
    assert len(left) == 1
    assert "module-top.toml: nothing else has the size" in left[0]


def test_a_module_is_measured_by_hand_where_nothing_else_tells_its_size(tmp_path: Path) -> None:
    cell = written(tmp_path / "cell", "antenna.toml")
    assert "its 3 marks are 4 mm wide and their middles spread over 24 x 10 mm" in check(cell)
    drawings = cell.parent / "connectors"
    shipped = drawings.resolve()
    drawings.unlink()
    shutil.copytree(shipped, drawings)
    top = drawings / "module-top.toml"
    text = top.read_text(encoding="utf-8").replace("= 4.0", "= 2.0").replace("12.0", "6.0")
    top.write_text(text.replace("5.0]", "2.5]"), encoding="utf-8")
    assert "its 3 marks are 2 mm wide and their middles spread over 12 x 5 mm" in check(cell)


def check(cell_file: Path) -> str:
    return CliRunner().invoke(whole_app(), ["check", str(cell_file)]).stdout


def test_what_recipes_share_is_said_once(new: Path) -> None:
    text = new.read_text(encoding="utf-8").replace("[110.0, 0.0, -50.0,", "[110.0, 0.0, 50.0,")
    recipe = text[text.index("[[recipes]]") :]
    other = recipe.replace("id = 1", "id = 2").replace('name = "', 'name = "other ')
    new.write_text(f"{text}\n{other}", encoding="utf-8")
    done = CliRunner().invoke(whole_app(), ["check", str(new)])
    assert "recipe 2" in done.stdout
    assert done.stdout.count("160 mm from what tray_look sees") == 1
    assert done.stdout.count("procedure 201") == 1
