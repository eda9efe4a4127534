"""A streamed setpoint that is refused ends its stream with the arm standing."""

import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.errors.base import CellError
from cellctl.errors.robot import NotRearmed, SetpointRefused, TargetOutOfBounds
from tests.rigs.wire.duco_rig import DucoRig, duco_rig
from tests.wire.siasun_rpc.duco_moves import move, rearm

GOOD = 4


async def refuse(rig: DucoRig, *, by_the_controller: bool) -> None:
    """Some setpoints that are followed, and one that is not."""
    limits = rig.robot.stream_offer().limits
    async with rig.robot.stream(limits) as stream:
        start = stream.report.base_T_flange
        for step in range(1, GOOD + 1):
            await stream.advance(_down(step * limits.step_m) * start)
        if by_the_controller:
            rig.logic.faults.inject("minus_one", count=1)
        far = GOOD + (1 if by_the_controller else 3)
        await stream.advance(_down(far * limits.step_m) * start)


def _down(way_m: float) -> RigidTransform:
    return RigidTransform.from_translation([0.0, 0.0, -way_m])


def setpoints(rig: DucoRig) -> list[float]:
    """Heights of the setpoints that arrive at the controller from now on, in metres."""
    heights: list[float] = []
    servo = rig.logic.servo

    def noted(pose: list[float], frames: tuple[str, str]) -> int:
        heights.append(pose[2])
        return servo(pose, frames)

    rig.logic.servo = noted  # type: ignore[method-assign]
    return heights


@pytest.mark.parametrize(
    ("by_the_controller", "fault", "arrived"),
    [(True, SetpointRefused, GOOD + 1), (False, TargetOutOfBounds, GOOD)],
    ids=["answered with -1", "too far"],
)
async def test_a_setpoint_that_is_refused(
    by_the_controller: bool,
    fault: type[CellError],
    arrived: int,
) -> None:
    async with duco_rig() as rig:
        await rig.robot.connect()
        heights, limits = setpoints(rig), rig.robot.stream_offer().limits
        before = rig.robot.state().base_T_flange
        with pytest.raises(fault):
            await refuse(rig, by_the_controller=by_the_controller)
        assert not rig.logic.moving()
        assert len(heights) == arrived
        assert before.translation[2] - min(heights) < (GOOD + 1.01) * limits.step_m
        with pytest.raises(NotRearmed):
            await move(rig, 1.0)
        await rearm(rig)
        await move(rig, 1.0)


@pytest.mark.parametrize("by_the_controller", [True, False])
async def test_an_arm_that_lags_behind_stands_at_the_last_setpoint_that_was_taken(
    *, by_the_controller: bool
) -> None:
    """A stop would let it run on through its dead time, beyond every setpoint."""
    async with duco_rig() as rig:
        rig.logic.servo_s = 0.08
        await rig.robot.connect()
        step_m = rig.robot.stream_offer().limits.step_m
        before = rig.robot.state().base_T_flange
        with pytest.raises((SetpointRefused, TargetOutOfBounds)):
            await refuse(rig, by_the_controller=by_the_controller)
        assert not rig.logic.moving()
        assert rig.logic.stops == 0
        here = rig.arm.encoder_pose(rig.logic.clock())
        travelled_m = before.translation[2] - here.translation[2]
        assert travelled_m == pytest.approx(GOOD * step_m, abs=1e-6)
        assert rig.robot.state().stop_latched
