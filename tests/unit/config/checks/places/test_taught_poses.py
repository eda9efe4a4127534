"""Taught poses and turns against the bounds of their robots."""

from pathlib import Path

from cellctl.config import problems
from tests.unit.config.devices_only import devices_only
from tests.unit.config.test_load import changed


def test_a_taught_pose_outside_the_workspace_is_found_by_forward_kinematics(tmp_path: Path) -> None:
    # Every joint is within its limits; the flange would stand 0.9 m below the box.
    low = "home = [0.0, -20.0, 130.0, 0.0, 0.0, 90.0]"
    (problem,) = problems(devices_only(tmp_path, "home = [0.0, -90.0, 90.0, 0.0, 90.0, 90.0]", low))
    assert (problem.key, problem.number) == ("robots.main.poses_deg.home", 305)
    assert "the flange comes to" in problem.allowed
    assert "teach the pose again" in problem.allowed


def test_a_taught_pose_beyond_the_joint_limits_is_found(tmp_path: Path) -> None:
    (problem,) = problems(devices_only(tmp_path, "home = [0.0,", "home = [95.0,"))
    assert problem.key == "robots.main.poses_deg.home"
    assert "joints [95.0" in problem.allowed


def test_the_turns_of_the_base_frame_are_held_against_the_workspace(tmp_path: Path) -> None:
    narrow = "joint_workspace_max_mm = [2500.0, 1100.0, 2400.0]"
    path = changed(tmp_path, box=("joint_workspace_max_mm = [2500.0, 1300.0, 2400.0]", narrow))
    (problem,) = problems(path)
    assert problem.key == "processes.deck-to-frame.base_frame_joints_deg"
    assert "by 50 deg each way" in problem.allowed


def with_way(folder: Path, end: str, via_deg: str) -> Path:
    stated = 'end = "deck_measure"\nvia_deg = [[0.0, -90.0, 120.0, 0.0, 84.0, 90.0]]'
    return devices_only(folder, stated, f'end = "{end}"\nvia_deg = [{via_deg}]')


def test_a_way_leads_from_one_taught_pose_to_another(tmp_path: Path) -> None:
    good = "[-20.0, -71.0, 114.0, -27.0, 80.0, 90.0]"
    assert problems(with_way(tmp_path, "deck_measure", good)) == []
    (problem,) = problems(with_way(tmp_path, "deck_mesure", good))
    assert problem.key == "robots.main.ways.0"
    assert "deck_measure" in problem.allowed


def test_the_points_of_a_way_are_held_against_the_bounds(tmp_path: Path) -> None:
    beyond = "[-95.0, -71.0, 114.0, -27.0, 80.0, 90.0]"
    (problem,) = problems(with_way(tmp_path, "deck_measure", beyond))
    assert (problem.key, problem.number) == ("robots.main.ways.0.via_deg", 305)


def test_a_way_without_a_point_is_no_way(tmp_path: Path) -> None:
    (problem,) = problems(with_way(tmp_path, "deck_measure", ""))
    assert problem.key == "robots.main.ways.0.via_deg"
