"""`cellctl check`: what a good cell file lacks for processes that have no recipe in it."""

from pathlib import Path

from typer.testing import CliRunner

from cellctl.cli.commands import whole_app

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
    lines = said_of("peg-in-hole", "deck.toml")
    assert any("arm: the cell lacks [robots.arm]" in line for line in lines)
