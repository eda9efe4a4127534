"""A taught pose in the text of a cell file: one line changes, and nothing else."""

import tomllib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cellctl.config.document.taught_pose_text import with_pose
from cellctl.errors.config import FileInvalid

CONFIG = Path(__file__).parents[4] / "config"
JOINTS = [0.0, -90.5, 90.123456, 1e-7, 45.0, -0.0]
WRITTEN = [0.0, -90.5, 90.12346, 0.0, 45.0, 0.0]
ANGLES = st.lists(st.floats(-360.0, 360.0), min_size=6, max_size=6)


def pose_of(text: str, robot: str, pose: str) -> list[float]:
    found: list[float] = tomllib.loads(text)["robots"][robot]["poses_deg"][pose]
    return found


@given(ANGLES)
def test_any_joints(joints: list[float]) -> None:
    changed = with_pose("[robots.arm.poses_deg]\n", "arm", "home", joints)
    assert pose_of(changed, "arm", "home") == pytest.approx(joints, abs=5.1e-6)


@pytest.mark.parametrize("name", ["deck.toml", "cell.toml", "small.toml", "antenna.toml"])
def test_in_every_file_that_is_shipped_one_line_changes(name: str) -> None:
    text = (CONFIG / name).read_text(encoding="utf-8")
    for robot, written in tomllib.loads(text)["robots"].items():
        for pose in written.get("poses_deg", {}):
            changed = with_pose(text, robot, pose, JOINTS, "taught 2026-11-23 10:00 UTC")
            assert pose_of(changed, robot, pose) == WRITTEN
            pairs = zip(text.splitlines(), changed.splitlines(), strict=True)
            assert sum(old != new for old, new in pairs) == 1


def test_the_persons_comment_stays_and_ours_is_replaced() -> None:
    text = "[robots.arm.poses_deg]\nhome = [0, 0, 0, 0, 0, 0]   # clear of all\n"
    once = with_pose(text, "arm", "home", JOINTS, "taught 2026-01-01 10:00 UTC")
    assert once.endswith("   # clear of all; taught 2026-01-01 10:00 UTC\n")
    twice = with_pose(once, "arm", "home", JOINTS, "taught 2026-02-02 11:00 UTC")
    assert twice.endswith("   # clear of all; taught 2026-02-02 11:00 UTC\n")
    assert pose_of(twice, "arm", "home") == WRITTEN


def test_an_array_over_several_lines_becomes_one() -> None:
    text = "[robots.arm.poses_deg]\n  home = [0, 0, # [a]\n   0, 0, 0, 0]  # b\n"
    text += "other = [1, 2, 3, 4, 5, 6]\n"
    changed = with_pose(text, "arm", "home", JOINTS)
    assert changed.splitlines()[1] == f"  home = {WRITTEN}   # b"
    assert pose_of(changed, "arm", "other") == [1, 2, 3, 4, 5, 6]


def test_a_new_pose_stands_behind_the_others() -> None:
    text = "[robots.arm.poses_deg]\nhome = [0, 0, 0, 0, 0, 0]\n"
    text += "\n# of the sensor\n[force_sensors.f]\nx = 1\n"
    changed = with_pose(text, "arm", "look", JOINTS, "taught now")
    assert changed.splitlines()[2] == f"look = {WRITTEN}   # taught now"
    assert changed.splitlines()[3:] == text.splitlines()[2:]


def test_a_robot_without_poses_gets_a_section() -> None:
    text = '[robots.arm]\ndriver = "x"\n\n[robots.arm.settings]\nhost = "h"\n'
    changed = with_pose(text, "arm", "home", JOINTS)
    assert pose_of(changed, "arm", "home") == WRITTEN
    assert tomllib.loads(changed)["robots"]["arm"]["settings"] == {"host": "h"}


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[robots.other]\nx = 1\n",
        "robots.arm.poses_deg.home = [1, 2, 3, 4, 5, 6]\n",
        "[robots]\narm = { poses_deg = { home = [1, 2, 3, 4, 5, 6] } }\n",
        'note = """\n[robots.arm.poses_deg]\n"""\n[robots.arm]\nposes_deg = { home = [1] }\n',
        "[robots.arm\n",
    ],
    ids=["empty", "other robot", "dotted", "inline", "in a text", "no toml"],
)
def test_what_cannot_be_placed_is_refused(text: str) -> None:
    with pytest.raises(FileInvalid):
        with_pose(text, "arm", "home", JOINTS)


@given(st.text("[]robtsamp_deg.h=123, \n#\"'{}", max_size=200))
def test_any_text(text: str) -> None:
    """Refused, or the pose is there and the rest says what it said."""
    try:
        changed = with_pose(text, "arm", "home", JOINTS)
    except FileInvalid:
        return
    assert pose_of(changed, "arm", "home") == WRITTEN
