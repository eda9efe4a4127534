"""Both fake controllers refuse what they must, and the driver says why."""

import pytest

from cellctl.errors.link import ReplyTimeout
from cellctl.errors.robot import ControllerFault, MotionAborted, MotionRejected, NotRearmed
from tests.rigs.wire.any_rig import AnyRig, Make, above, move, rearm, stands, until_moving, within
from tests.rigs.wire.job_rig import JobRig
from tests.rigs.wire.refusals import REFUSALS


@pytest.mark.parametrize("reason", REFUSALS)
async def test_a_command_that_the_driver_would_not_send(rig: AnyRig, reason: str) -> None:
    await within(3.0, move(rig, 1.0))
    if reason == "LATCHED":
        await rig.robot.stop()
    refusal, before = REFUSALS[reason], rig.robot.state().base_T_flange
    record = refusal.send(rig)
    with pytest.raises(refusal.fault, match=refusal.words or reason):
        await rig.robot._command.run(record, 1.0)
    assert not rig.controller.moving()
    assert rig.robot.state().distance_to(before)[0] < 1e-6
    if isinstance(rig, JobRig):
        assert reason in rig.controller.tasks["SJLMAIN"].entered


async def test_a_command_that_is_not_answered_is_stopped(rig: AnyRig) -> None:
    """The jobs begin the motion whose answer is lost; nobody may believe that it did not begin."""
    rig.controller.faults.inject("never_ack", count=1)
    target = above(rig, 100.0)
    with pytest.raises(ReplyTimeout):
        await within(4.0, move(rig, 100.0, 0.02))
    await stands(rig)
    assert rig.robot._latch is not None
    await rearm(rig)
    assert rig.robot.state().distance_to(target)[0] > 0.05
    await within(5.0, move(rig, 1.0))


async def test_an_end_that_crosses_a_stop_leaves_the_arm_latched(rig: AnyRig) -> None:
    """The end of the motion is on the way to the PC when it asks for a stop."""
    rig.wires["CMD"].forth.delay_s = 0.2
    moving = move(rig, 3.0)
    await until_moving(rig)
    await stands(rig)
    assert rig.robot._command.running, "the end is not known yet"
    await within(2.0, rig.robot.stop())
    with pytest.raises(MotionAborted, match="STOP"):
        await within(1.0, moving)
    with pytest.raises(NotRearmed):
        await move(rig, 1.0)
    rig.wires["CMD"].forth.delay_s = 0.0
    # The late end is passed over and is not taken for one of the next motion.
    await rearm(rig)
    await within(3.0, move(rig, 1.0))


async def test_an_override_of_nothing_moves_nothing(rig: AnyRig) -> None:
    before = rig.robot.state().base_T_flange
    rig.controller.faults.inject("override_zero")
    await rig.robot._state.wait(lambda status: status.override_percent == 0, 1.0)
    assert rig.robot.state().speed_override_ratio == 0.0
    # The jobs cannot ask before they move: there it is an alarm of the controller.
    with pytest.raises((MotionRejected, ControllerFault)):
        await within(3.0, move(rig, 20.0))
    assert not rig.controller.moving()
    assert rig.robot.state().distance_to(before)[0] < 1e-6


@pytest.mark.parametrize("reason", ["LIMIT", "REACH", "SINGULAR", "LOAD"])
async def test_a_target_that_the_controller_finds_wrong_moves_nothing(
    make: Make, reason: str
) -> None:
    """The jobs cannot ask for these either; which of them it was stands in the vendor's number."""
    async with make(controller_errors={"4100": {"text": "see pendant", "remedy": "-"}}) as rig:
        await rig.connect()
        before = rig.robot.state().base_T_flange
        rig.controller.faults.inject("reject", count=1, reason=reason)
        with pytest.raises((MotionRejected, ControllerFault), match=f"{reason}|4100, see pendant"):
            await within(3.0, move(rig, 20.0))
        assert not rig.controller.moving()
        assert rig.robot.state().distance_to(before)[0] < 1e-6
        if isinstance(rig, JobRig):
            assert reason in rig.controller.alarm


async def test_a_release_during_a_motion_is_not_even_sent(rig: AnyRig) -> None:
    target = above(rig, 20.0)
    moving = move(rig, 20.0)
    await until_moving(rig)
    with pytest.raises(MotionRejected, match="while a motion runs"):
        await rig.robot.rearm()
    state = await within(3.0, moving)
    assert state.distance_to(target)[0] < 1e-5


@pytest.mark.parametrize("stopped_for_s", [0.25, 0.5])
async def test_a_controller_that_stops_late_is_waited_for(
    rig: AnyRig, stopped_for_s: float
) -> None:
    """It runs on by its latency; the stop is told when the arm stands and not before."""
    rig.controller.faults.inject("stop_latency", latency_s=stopped_for_s)
    moving = move(rig, 100.0, 0.05)
    await until_moving(rig)
    asked = rig.robot.state().base_T_flange
    await within(2.0, rig.robot.stop())
    assert not rig.controller.moving()
    with pytest.raises(MotionAborted):
        await moving
    assert rig.robot.state().distance_to(asked)[0] >= 0.05 * stopped_for_s * 0.9
