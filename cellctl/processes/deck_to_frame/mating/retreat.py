"""What follows a fault of the mating: the arm is stopped and, where that is right, backs off from
the frame."""

from cellctl import log
from cellctl.cell.guarded_motion.leaving import able_to_leave
from cellctl.errors.base import CellError
from cellctl.errors.force import (
    ForceError,
    ForceLimitExceeded,
    SensorDataInvalid,
    SensorFrozen,
    SensorRateWrong,
    SensorSaturated,
    SensorSilent,
)
from cellctl.errors.line import LineLostInContact
from cellctl.processes.deck_to_frame.faults import (
    ContactEarly,
    ContactLate,
    CreepNotConverged,
    LateralLoad,
    MatingOverforce,
)
from cellctl.processes.deck_to_frame.mating.attempt import Attempt
from cellctl.processes.deck_to_frame.mating.back_off import back_off

_log = log.get(__name__)

_PRESSES_ON = (
    ContactEarly,
    ContactLate,
    LateralLoad,
    CreepNotConverged,
    MatingOverforce,
    ForceLimitExceeded,
    SensorSilent,
    SensorSaturated,
    SensorDataInvalid,
    SensorFrozen,
    SensorRateWrong,
    LineLostInContact,
)
"""Faults found by mating or guard while the arm may press on the frame with a force that nobody
knows or wants, and a lost line where the recipe wants to leave the contact then. Robot, guard and
links work with these; any other fault leaves the arm alone."""


async def retreat(attempt: Attempt, fault: CellError) -> None:
    """Stop, attach the curve, back off where that is right; what fails is noted on the fault.

    Aborts, stops and mode changes never come here: they cancel the mating.
    """
    try:
        await _stop(attempt, fault)
        if isinstance(fault, _PRESSES_ON) and able_to_leave(attempt.robot, attempt.guard):
            # The guard must be released first: as long as it wants a stop, it asks for one again at
            # the next beat.
            await attempt.guard.acknowledge()
            await attempt.robot.rearm()
            await back_off(attempt)
    except CellError as second:
        fault.add_note(f"while retreating: {second}")
        _log.warning("retreat incomplete", fault=str(fault), second=str(second))


async def _stop(attempt: Attempt, fault: CellError) -> None:
    """Stop, then attach the curve: making it may fail, and must not stand before the stop."""
    try:
        await attempt.robot.stop()
    finally:
        if isinstance(fault, ForceError):
            fault.curve = attempt.recorder.curve()
