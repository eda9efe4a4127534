"""`cellctl check`: what a good cell file lacks for processes that have no recipe in it."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.cli.commands import whole_app
from tests.rigs.sweeps import sweep
from tests.unit.config.test_mistakes import written

CONFIG = Path(__file__).parents[3] / "config"


def said_of(process: str, cell_file: str) -> list[str]:
    """The lines about one process, without those of the next."""
    done = CliRunner().invoke(whole_app(), ["check", str(CONFIG / cell_file)])
    assert done.exit_code == 0, done.output
    lines = done.stdout.splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith(f"  process {process}"))
    rest = [i for i, line in enumerate(lines) if i > first and not line.startswith("     ")]
    return lines[first : min(rest, default=len(lines))]


def test_a_pose_that_is_not_taught_is_named_by_its_key() -> None:
    head, pose = said_of("peg-in-hole", "small.toml")
    assert "not complete" in head
    assert pose.strip().startswith("robots.arm.poses_deg.above_hole: a taught pose")


def test_poses_of_one_robot_make_one_line() -> None:
    poses = [line for line in said_of("antenna-module", "small.toml") if "poses_deg" in line]
    assert len(poses) == 1
    for name in ("tray_look", "inspect_plug", "socket_look"):
        assert f"robots.arm.poses_deg.{name}" in poses[0]


def test_a_device_that_is_not_there_is_named_by_its_role_and_table() -> None:
    lines = said_of("antenna-module", "small.toml")
    assert any("gripper: the cell lacks [grippers.gripper]" in line for line in lines)


def test_a_cell_with_recipes_is_not_told_what_it_lacks_for_others() -> None:
    done = CliRunner().invoke(whole_app(), ["check", str(CONFIG / "deck.toml")])
    assert done.exit_code == 0
    assert "process " not in done.stdout


_PLACE = "flange_T_sensor = [0.0, 0.0, 30.0, "


@pytest.mark.parametrize("name", sweep(("insertion-pin.toml", "antenna.toml"), ("antenna.toml",)))
@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("", "", "its z points along that of the flange, its x is turned by 0 deg about z"),
        (f"{_PLACE}0.0, ", f"{_PLACE}90.0, ", "its x is turned by 90 deg about z of the flange"),
        (f"{_PLACE}0.0, 0.0, 0.0]", f"{_PLACE}0.0, 0.0, 180.0]", "its z points against that of"),
        ("max_lag_s = 0.9,", "max_lag_s = 0.9, inverted = true,", "turns all its signs"),
    ],
)
def test_it_says_how_a_force_sensor_lies(
    tmp_path: Path, name: str, old: str, new: str, said: str
) -> None:
    """In a cell that weighs nothing no other value contradicts it: a push by hand does."""
    path = written(tmp_path / "cell", name, old, new)
    done = CliRunner().invoke(whole_app(), ["check", str(path)])
    assert said in done.stdout
    assert "while the tool is pushed towards the flange" in done.stdout


def test_what_the_daemon_needs_of_its_pc_is_a_hint(tmp_path: Path) -> None:
    path = written(
        tmp_path,
        "deck.toml",
        'data_dir = "runs/cell"',
        'data_dir = "runs/cell"\n[local_api]\ngroup = "nobody-has-this"\n',
    )
    text = path.read_text()
    calibrations = 'calibration_dir = "demo-calibration"\n'
    path.write_text(calibrations + text.replace(calibrations, "", 1))
    done = CliRunner().invoke(whole_app(), ["check", str(path)])
    assert done.exit_code == 0, done.output
    assert "local_api.group nobody-has-this: this PC has no such group" in done.output


def test_a_processor_that_this_pc_lacks_is_a_hint(tmp_path: Path) -> None:
    path = written(tmp_path, "deck.toml", "stale_ms = 300.0", "stale_ms = 300.0\ncpu = 255")
    done = CliRunner().invoke(whole_app(), ["check", str(path)])
    assert done.exit_code == 0, done.output
    assert "force_sensors.force.cpu 255: this PC has processors 0 to" in done.output


def test_a_data_folder_that_may_not_be_written_is_a_hint(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # The tests may run as root, who may write everywhere.
    asked = "cellctl.cli.commissioning.hints.may_write"
    monkeypatch.setattr(asked, lambda folder: folder != Path("runs/cell"))
    done = CliRunner().invoke(whole_app(), ["check", str(written(tmp_path, "deck.toml"))])
    assert done.exit_code == 0, done.output
    assert "data_dir runs/cell: this user may not write it" in done.output
    assert "calibration_dir" not in done.output


@pytest.mark.parametrize(
    ("folder", "said"),
    [("elsewhere/calibrations", "no such folder on this PC"), ("features", "holds no calibration")],
)
def test_a_folder_without_calibrations_is_a_hint(tmp_path: Path, folder: str, said: str) -> None:
    path = written(tmp_path, "deck.toml", '"demo-calibration"', f'"{folder}"')
    done = CliRunner().invoke(whole_app(), ["check", str(path)])
    assert done.exit_code == 0, done.output
    assert f"calibration_dir {tmp_path / folder}: {said}: right for a cell that is still" in (
        done.output
    )
    as_json = json.loads(CliRunner().invoke(whole_app(), ["check", str(path), "--json"]).stdout)
    assert any(said in hint for hint in as_json["hints"])


def test_every_move_is_held_against_the_model_beside_the_file(tmp_path: Path) -> None:
    cell_file = written(tmp_path, "insertion-pin.toml")
    done = CliRunner().invoke(whole_app(), ["check", "--moves", str(cell_file)])
    assert done.exit_code == 0, done.output
    assert "every move is free, by the model" in done.stdout
    # A block beside the part, on the way of the arm.
    model = tmp_path / "insertion-pin.model.toml"
    text = model.read_text(encoding="utf-8")
    model.unlink()
    size, at = "[120.0, 120.0, 200.0]", "[400.0, -200.0, 240.0, 0.0, 0.0, 0.0]"
    block = f"block = {{ box = {{ size_mm = {size}, at = {at} }} }}"
    model.write_text(text.replace("[fixtures]", f"[fixtures]\n{block}"))
    done = CliRunner().invoke(whole_app(), ["check", "--moves", "--json", str(cell_file)])
    assert done.exit_code == 1
    found = json.loads(done.stdout)
    assert not found["good"]
    assert any(
        "arm.gripper and block" in text or "arm.pin and block" in text for text in found["moves"]
    )


def test_programs_are_told_what_was_not_checked(tmp_path: Path) -> None:
    """The same lines as on the terminal; none of a file with errors."""
    (tmp_path / "empty").mkdir()
    old, new = (f'calibration_dir = "{name}"' for name in ("antenna-calibration", "empty"))
    cell_file = written(tmp_path, "antenna.toml", old, new)
    shown = CliRunner().invoke(whole_app(), ["check", str(cell_file)]).stdout
    told = json.loads(CliRunner().invoke(whole_app(), ["check", str(cell_file), "--json"]).stdout)
    mark = "  not checked yet: "
    lines = [line.removeprefix(mark) for line in shown.splitlines() if line.startswith(mark)]
    assert lines
    assert told["not_checked_yet"] == lines
    assert told["not_checked"] == []


@pytest.mark.parametrize(
    ("old", "new", "number", "said"),
    [
        ("[robots.main]", "[robots.main", 101, "(at line "),
        ("rated_deg_s", "rated_dgs_s", 102, "rated_deg_s"),
    ],
)
def test_a_model_that_cannot_be_read_is_an_error_of_the_cell(
    tmp_path: Path, old: str, new: str, number: int, said: str
) -> None:
    """What the cell file would be held against is not there, and nothing else says so."""
    path = written(tmp_path, "deck.toml", "", "")
    text = (CONFIG / "deck.model.toml").read_text()
    line = text[: text.index(old)].count("\n") + 1
    model = path.with_suffix(".model.toml")
    model.unlink()  # a link to the shipped one
    model.write_text(text.replace(old, new, 1))
    done = CliRunner().invoke(whole_app(), ["check", str(path)])
    assert done.exit_code == 1
    assert "good" not in done.stdout
    assert f"F{number} {model.name}" in done.stdout
    assert f"line {line}" in done.stdout
    assert said in done.stdout
    told = json.loads(CliRunner().invoke(whole_app(), ["check", "--json", str(path)]).stdout)
    assert not told["good"]
    assert {one["number"] for one in told["errors"]} == {number}
