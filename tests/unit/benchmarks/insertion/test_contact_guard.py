"""What the sensor of the cell without wires makes of milliseconds that it gets together."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from benchmarks.insertion.contact_guard import InsertionGuard, SensorFault, SensorNoise
from cellctl.cell.contact_motion.frames import ContactFrames
from cellctl.cell.guarded_motion.guard_limits import Sensing, guard_limits
from cellctl.cell.guarded_motion.guarded_moves import WrenchTolerance
from cellctl.geometry.pose import Array
from cellctl.guard.report import TripReason

LIMITS = guard_limits(WrenchTolerance(20.0, 2.0).limits, Sensing(1000.0, 0.01, 0.1))
MILLISECONDS = 48


def _frames() -> ContactFrames:
    flange_T_tip = RigidTransform.from_components(
        [0.01, -0.02, 0.2], Rotation.from_rotvec([0, 1, 0])
    )
    return ContactFrames(RigidTransform.identity(), flange_T_tip, Rotation.identity())


def _guard(fault: SensorFault | None = None) -> InsertionGuard:
    guard = InsertionGuard(SensorNoise(0.1, 0.003, np.random.default_rng(4)), fault)
    guard.give_in(_frames())
    return guard


def _given(guard: InsertionGuard, wrenches: Array, at_once: int) -> None:
    flange = np.eye(4)
    flange[:3, :3] = Rotation.from_rotvec([0.3, -0.2, 0.5]).as_matrix()
    flange[:3, 3] = 0.4, 0.1, 0.6
    for begin in range(0, len(wrenches), at_once):
        some = wrenches[begin : begin + at_once]
        times_s = [1e-3 * (begin + n + 1) for n in range(len(some))]
        guard.publish(times_s, np.broadcast_to(flange, (len(some), 4, 4)), some)


@pytest.fixture
def pushed() -> Array:
    """A force that grows beyond the limit, with a moment about the origin of the base."""
    sizes = np.linspace(0.0, 40.0, MILLISECONDS)
    return np.outer(sizes, [0.2, -0.1, 1.0, 0.05, 0.02, -0.03])


@pytest.mark.parametrize("at_once", [8, 16, MILLISECONDS])
async def test_it_does_not_matter_how_many_come_together(pushed: Array, at_once: int) -> None:
    one, many = _guard(), _guard()
    for guard, together in ((one, 1), (many, at_once)):
        await guard.arm(LIMITS)
        _given(guard, pushed, together)
    np.testing.assert_allclose(
        many.samples(0.0).wrench, one.samples(0.0).wrench, rtol=0, atol=1e-12
    )
    assert one.trip is not None
    assert many.trip == one.trip


async def test_the_first_beyond_its_limit_trips(pushed: Array) -> None:
    guard = _guard()
    await guard.arm(LIMITS)
    _given(guard, pushed, MILLISECONDS)
    assert guard.trip is not None
    assert guard.trip.reason is TripReason.FILTERED_LIMIT
    seen = guard.samples(0.0)
    beyond = (np.abs(seen.wrench) > LIMITS.filtered).any(axis=1)
    assert guard.trip.time_s > seen.time_s[beyond.argmax()]


async def test_a_sensor_that_repeats_itself_trips() -> None:
    fault = SensorFault(lambda _sample, last: last)
    fault.begins_s = 0.010
    guard = _guard(fault)
    await guard.arm(LIMITS)
    _given(guard, np.zeros((MILLISECONDS, 6)), 8)
    assert guard.trip is not None
    assert guard.trip.reason is TripReason.SENSOR_FROZEN
    # The last good sample and those that repeat it.
    assert guard.trip.time_s == pytest.approx(1e-3 * (9 + LIMITS.frozen_samples - 1))


def test_a_force_is_felt_about_the_tip() -> None:
    guard, frames = _guard(), _frames()
    flange = np.eye(4)
    tip = flange @ frames.flange_T_tip.as_matrix()
    force = np.array([1.0, 2.0, 3.0])
    # Through the tip: no moment there, whatever it is about the base.
    through = np.concatenate([force, np.cross(tip[:3, 3], force)])
    rows = np.tile(100.0 * through, (MILLISECONDS, 1))
    times_s = [1e-3 * (n + 1) for n in range(MILLISECONDS)]
    guard.publish(times_s, np.broadcast_to(flange, (MILLISECONDS, 4, 4)), rows)
    settled = guard.samples(0.03).wrench.mean(axis=0)
    np.testing.assert_allclose(settled[:3], 100.0 * tip[:3, :3].T @ force, atol=0.2)
    np.testing.assert_allclose(settled[3:], 0.0, atol=0.01)
