"""What presses or pulls on a part is known in a new daemon by the zero that was kept."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.cell.guarded_motion.free_moves import free_tolerance, guarded_section
from cellctl.cell.guarded_motion.guarded_moves import WrenchTolerance, guarded_moves
from cellctl.cell.guarded_motion.kept_zero import (
    Pressed,
    forget_zero,
    keep_zero,
    kept_zero,
    pressed_since,
)
from cellctl.cell.guarded_motion.leaving import pressed_n
from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.errors.force import ForceLimitExceeded
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.guard.report import GuardTrip, TripReason
from tests.unit.cell.bench import Bench, make_bench

MOST_N = 50.0
TILTED = pose_from_xyzabc([0.0, 0.0, 0.0, 90.0, 0.0, 0.0])
"""The frame of the part in the sensor: its z lies along an axis of the sensor other than z."""
OFFSET = np.array([31.0, -12.0, -1990.0, 1.0, 2.0, 3.0])
"""What the sensor reads of load and drift."""


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    bench = make_bench(tmp_path)
    bench.cell.zero_folder = tmp_path / "zeros"
    return bench


def feel(bench: Bench, along_z_n: float) -> None:
    """The true force on the part along z of its frame, beside what the sensor reads anyway."""
    force = np.concatenate([TILTED.rotation.apply([0.0, 0.0, along_z_n]), np.zeros(3)])
    noise = np.random.default_rng(1).normal(0.0, 0.2, (200, 6))
    bench.cell.guard.raw = OFFSET + force + noise


def started_anew(bench: Bench) -> GuardedRobot:
    guard = bench.cell.guard
    guard.in_part_frame = guard.gravity_compensated = False
    guard.hidden_axial_n = None
    return bench.deck.arm


@pytest.mark.parametrize(
    ("inwards", "hidden_n", "change_n", "found_n"),
    [
        pytest.param(1.0, 0.0, 18.0, -18.0, id="pulled"),
        pytest.param(1.0, 25.0, 10.0, 15.0, id="half relieved"),
        pytest.param(-1.0, 0.0, -18.0, -18.0, id="z out of the place"),
        pytest.param(1.0, 0.0, -80.0, MOST_N, id="more than can be"),
    ],
)
async def test_a_new_daemon_knows_what_the_old_one_knew(
    bench: Bench, inwards: float, hidden_n: float, change_n: float, found_n: float
) -> None:
    feel(bench, -inwards * hidden_n)
    await keep_zero(bench.deck.arm, TILTED, Pressed(inwards, hidden_n))
    feel(bench, -inwards * hidden_n + change_n)
    found = await pressed_n(started_anew(bench), inwards, MOST_N)
    assert found == pytest.approx(found_n, abs=0.1)


async def test_without_a_kept_zero_it_is_the_most_that_can_be(bench: Bench) -> None:
    feel(bench, 18.0)
    assert await pressed_n(started_anew(bench), 1.0, MOST_N) == MOST_N


async def test_a_daemon_that_keeps_none_knows_none(bench: Bench) -> None:
    bench.cell.zero_folder = None
    feel(bench, 0.0)
    await keep_zero(bench.deck.arm, TILTED, Pressed(1.0, 0.0))
    assert await kept_zero(bench.deck.arm) is None


async def test_a_zero_of_another_attitude_or_sensor_does_not_tell(bench: Bench) -> None:
    feel(bench, 0.0)
    await keep_zero(bench.deck.arm, TILTED, Pressed(1.0, 0.0))
    kept = await kept_zero(bench.deck.arm)
    assert kept is not None
    main, stood = bench.cell.main, bench.cell.main.flange
    main.flange = stood * pose_from_xyzabc([0.0, 0.0, 30.0, 0.0, 0.5, 0.0])
    assert await pressed_since(bench.deck.arm, kept) == pytest.approx(0.0, abs=0.1)
    main.flange = stood * pose_from_xyzabc([0.0, 0.0, 0.0, 0.0, 2.0, 0.0])
    assert await pressed_since(bench.deck.arm, kept) is None
    main.flange = stood
    bench.cell.guard.serial = "M4347K-2"
    assert await pressed_since(bench.deck.arm, kept) is None


async def test_a_guard_that_gives_no_samples_does_not_tell(bench: Bench) -> None:
    feel(bench, 0.0)
    await keep_zero(bench.deck.arm, TILTED, Pressed(1.0, 0.0))
    bench.cell.guard.raw = np.empty((0, 6))
    assert await pressed_n(started_anew(bench), 1.0, MOST_N) == MOST_N


@pytest.mark.parametrize(
    "text",
    ["", "{}", "[1, 2]", '{"taken": 5}', "\x00\x01"],
)
async def test_a_file_that_is_none_is_passed_over(bench: Bench, text: str) -> None:
    arm = bench.deck.arm
    assert arm.zero_file is not None
    arm.zero_file.parent.mkdir()
    arm.zero_file.write_text(text)
    assert await kept_zero(arm) is None
    await forget_zero(arm)
    assert not arm.zero_file.exists()


@pytest.mark.parametrize(
    ("key", "value"),
    [("sensor_n", [1.0, 2.0]), ("pull_axis", [1.0, "nan", 0.0]), ("taken", "2026-11-28T06:00:00")],
)
async def test_no_part_of_it_is_guessed(bench: Bench, key: str, value: object) -> None:
    feel(bench, 0.0)
    arm = bench.deck.arm
    await keep_zero(arm, TILTED, Pressed(1.0, 0.0))
    assert arm.zero_file is not None
    content = json.loads(arm.zero_file.read_text())
    arm.zero_file.write_text(json.dumps(content | {key: value}))
    assert await kept_zero(arm) is None


async def test_a_disk_that_takes_nothing_keeps_no_arm_from_leaving(
    bench: Bench, tmp_path: Path
) -> None:
    (tmp_path / "zeros").write_text("no folder")
    feel(bench, 0.0)
    await keep_zero(bench.deck.arm, TILTED, Pressed(1.0, 0.0))
    await forget_zero(bench.deck.arm)
    assert await kept_zero(bench.deck.arm) is None


async def test_what_was_held_is_known_until_the_arm_goes_off_freely(bench: Bench) -> None:
    cell, arm, guard = bench.as_cell, bench.deck.arm, bench.cell.guard
    feel(bench, -20.0)
    tolerance = WrenchTolerance(20.0, 5.0)

    async def leave() -> None:
        leaves = Pressed(1.0, 20.0)
        frame = arm.flange_T_sensor * TILTED
        async with guarded_moves(cell, arm, frame, tolerance, leaves=leaves) as move:
            kept = await kept_zero(arm)
            assert kept is not None, "before anything pulls"
            assert kept.pressed == leaves
            assert not kept.held
            up = RigidTransform.from_translation([0.0, 0.0, 0.01]) * bench.cell.main.flange
            await move(arm.robot.step(up, speed_m_s=0.001))

    guard.trip = GuardTrip(TripReason.FILTERED_LIMIT, 1.0, "Fz 51.0 N, limit 50.00 N", 2, 51.0)
    with pytest.raises(ForceLimitExceeded):
        await leave()
    kept = await kept_zero(arm)
    assert kept is not None
    assert "Fz 51.0 N" in kept.held
    guard.trip = None
    async with guarded_section(started_anew(bench), free_tolerance(arm)):
        assert await kept_zero(arm) is None
