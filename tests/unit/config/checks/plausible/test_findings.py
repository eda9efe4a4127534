"""What `cellctl check` refuses and a daemon takes; and what neither of them minds."""

from pathlib import Path

from cellctl.config import problems, problems_before_commissioning
from tests.unit.config.test_mistakes import CONFIG, written

_HOME = "home = [0.0, -90.0, 90.0, 0.0, 90.0, 90.0]"
_COPIED = "home = [0.0, -52.76637, 109.14017, 0.0, 33.6262, 90.0]"


def test_a_daemon_takes_what_is_only_implausible(tmp_path: Path) -> None:
    path = written(tmp_path, "deck.toml", _HOME, _COPIED)
    assert problems(path) == []
    (found,) = problems_before_commissioning(path)
    assert found.key == "robots.main.poses_deg.deck_measure"


def test_a_device_that_is_wrong_itself_is_named_once(tmp_path: Path) -> None:
    path = written(tmp_path, "deck.toml", "rate_hz = 1000", "rate_hz = 0.5")
    found = problems_before_commissioning(path)
    assert [one.key for one in found] == ["force_sensors.force.settings.rate_hz"]
    assert "1 to 4000" in found[0].allowed


def test_folders_of_two_cells_may_differ_by_a_number(tmp_path: Path) -> None:
    path = written(tmp_path, "deck.toml", '"demo-calibration"', '"cell-2-calibration"')
    (tmp_path / "cell-1-calibration").mkdir()
    assert problems_before_commissioning(path) == []
    (tmp_path / "cel-2-calibration").mkdir()
    (found,) = problems_before_commissioning(path)
    assert found.key == "calibration_dir"
    assert "'cel-2-calibration'" in found.allowed


def test_an_arm_may_rise_out_of_a_low_box_and_go_home_over_it(tmp_path: Path) -> None:
    box = 'max_mm = [2400.0, 800.0, 1900.0], way_out = "-x"'
    for top, keys in (("1500.0", []), ("1900.0", ["zones.beside_head_1.robots.aux_1.way_out"])):
        upwards = box.replace("1900.0", top).replace("-x", "+z")
        path = written(tmp_path / top, "deck.toml", box, upwards)
        assert [one.key for one in problems_before_commissioning(path)] == keys


def test_any_host_name_passes_that_does_not_resemble_localhost(tmp_path: Path) -> None:
    old = 'host = "127.0.0.1", port = 7101'
    for name in ("localhost", "head-1.cell.local", "lab-host-2", "camera"):
        path = written(tmp_path / name, "deck.toml", old, f'host = "{name}", port = 7101')
        assert problems_before_commissioning(path) == [], name


def test_a_time_limit_of_zero_is_left_to_the_driver(tmp_path: Path) -> None:
    old = 'settings = { host = "127.0.0.1", port = 7103 }'
    new = 'settings = { host = "127.0.0.1", port = 7103, frame_timeout_s = 0.0 }'
    assert problems_before_commissioning(written(tmp_path, "deck.toml", old, new)) == []


def test_an_arm_without_kinematics_is_judged_by_the_longest_that_are_sold(tmp_path: Path) -> None:
    box = "workspace_max_mm = [2500.0, 900.0, 2400.0]"
    for far_mm, keys in ((5900, []), (6100, ["robots.main.settings.workspace_max_mm"])):
        new = f"workspace_max_mm = [{far_mm}.0, 900.0, 2400.0]"
        path = written(tmp_path / str(far_mm), "cell.toml", box, new)
        assert [one.key for one in problems_before_commissioning(path)] == keys


def test_every_shipped_cell_file_is_plausible() -> None:
    names = [
        path
        for path in CONFIG.glob("*.toml")
        if not path.name.endswith((".scenario.toml", ".model.toml"))
    ]
    assert len(names) >= 10
    assert {path.name: problems_before_commissioning(path) for path in names} == {
        path.name: [] for path in names
    }
