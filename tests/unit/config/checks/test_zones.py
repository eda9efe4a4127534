"""Zones of a cell file: robots, boxes, clear poses, and what the check says of them."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.cli.commands import whole_app
from cellctl.config import problems
from tests.unit.config.devices_only import devices_only

AUX = "aux_1 = { min_mm = [1450.0"


def test_a_zone_names_robots_of_the_cell(tmp_path: Path) -> None:
    order, robot = problems(devices_only(tmp_path, AUX, AUX.replace("aux_1", "aux_3")))
    assert robot.key == "zones.beside_head_1.robots.aux_3"
    assert robot.allowed == "a robot of this cell: main, aux_1, aux_2"
    assert order.key == "zones.beside_head_1.retreat"
    assert order.allowed == "a robot of this zone: main, aux_3"


def test_a_zone_has_its_lower_corner_below_its_upper_one(tmp_path: Path) -> None:
    (problem,) = problems(devices_only(tmp_path, AUX, AUX.replace("1450.0", "2450.0")))
    assert problem.key == "zones.beside_head_1.robots.aux_1.min_mm"
    assert "min_mm must lie below max_mm" in problem.allowed


def test_a_zone_of_one_robot_is_none(tmp_path: Path) -> None:
    (problem,) = problems(devices_only(tmp_path, AUX, f"# {AUX}"))
    assert problem.key == "zones.beside_head_1.robots"


@pytest.mark.parametrize(
    ("poses", "expected"),
    [('["retracted"]', "left out"), ('["retarded"]', "measuring, retracted")],
)
def test_clear_poses_are_taught_ones_of_a_robot_without_kinematics(
    tmp_path: Path, poses: str, expected: str
) -> None:
    corner = "max_mm = [2400.0, 800.0, 1900.0]"
    found = problems(devices_only(tmp_path, corner, f"{corner}, clear_poses = {poses}"))
    assert {one.key for one in found} == {"zones.beside_head_1.robots.aux_1.clear_poses"}
    assert any(expected in one.allowed for one in found)


@pytest.mark.parametrize("name", ["deck.toml", "cell.toml"])
def test_check_says_which_taught_poses_a_zone_holds(tmp_path: Path, name: str) -> None:
    # By forward kinematics in the fake cell, by what is not listed as clear in the template.
    path = devices_only(tmp_path, name=name)
    path.write_text(path.read_text().replace("FILL IN", "found"))
    output = CliRunner().invoke(whole_app(), ["check", str(path)]).output
    assert "holds of main: no taught pose; of aux_2: measuring" in output
    assert "leaves first: main, then aux_2" in output


@pytest.mark.parametrize(
    ("order", "key", "allowed"),
    [
        ('["main", "main"]', "zones.beside_head_1.retreat", "twice"),
        ('["main", "aux_2"]', "zones.beside_head_1.retreat", "main, aux_1"),
    ],
)
def test_an_order_of_retreat_is_one_of_the_robots_of_its_zone(
    tmp_path: Path, order: str, key: str, allowed: str
) -> None:
    (problem,) = problems(devices_only(tmp_path, '["main", "aux_1"]', order))
    assert problem.key == key
    assert allowed in problem.allowed


def test_two_zones_may_not_have_two_robots_leave_in_two_orders(tmp_path: Path) -> None:
    shares = (
        "main = { min_mm = [0.0, 0.0, 0.0], max_mm = [100.0, 100.0, 100.0], way_out = '-x' }\n"
        "aux_1 = { min_mm = [0.0, 0.0, 0.0], max_mm = [100.0, 100.0, 100.0], way_out = '+x' }\n"
    )
    other = f'[zones.other]\nretreat = ["aux_1", "main"]\n[zones.other.robots]\n{shares}\n'
    heading = "[zones.beside_head_2]"
    (problem,) = problems(devices_only(tmp_path, heading, other + heading))
    assert problem.key == "zones.other.retreat"
    assert problem.allowed == "main before aux_1, as in zones.beside_head_1.retreat"


def test_a_robot_of_the_order_has_a_way_out(tmp_path: Path) -> None:
    (problem,) = problems(devices_only(tmp_path, ', way_out = "+y"', ""))
    assert problem.key == "zones.beside_head_1.robots.main.way_out"
