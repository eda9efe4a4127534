"""Which faults make which calibrations worthless, and what is done then.

A fault is here when what caused it may have moved or bent something that a calibration holds for,
or has proved a figure wrong. Faults with a likelier harmless cause (a bad part, a jogged robot
that returns by its encoders) are not: whoever finds a moved head says so with
``cellctl calibrate invalidate``.
"""

import asyncio

from cellctl import log
from cellctl.errors import CellError
from cellctl.errors.force import (
    ForceLimitExceeded,
    LiftOffHeld,
    MatingOverforce,
    SensorSaturated,
)
from cellctl.errors.robot import ControllerFault
from cellctl.errors.vision import CorrectionDiverging
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.store import RunStore
from cellctl.runtime.calibration_folder import PAYLOAD, CalibrationFolder
from cellctl.runtime.commissioned import CONTACT_STIFFNESS, STOP_LATENCY

_log = log.get(__name__)

INVALIDATED_BY: dict[type[CellError], tuple[str, ...]] = {
    # Collision detection of a robot comes as an error of its controller.
    ControllerFault: ("board_transfer", PAYLOAD),
    # Heads and main robot do not agree any more where things are.
    CorrectionDiverging: ("board_transfer",),
    # Gripper, deck and sensor were loaded beyond what the plan allows.
    SensorSaturated: (PAYLOAD,),
    LiftOffHeld: (PAYLOAD,),
    # Contact where none was expected: the deck may have met a head.
    ForceLimitExceeded: ("board_transfer", PAYLOAD),
    # The figures it was planned with were wrong.
    MatingOverforce: (PAYLOAD, STOP_LATENCY, CONTACT_STIFFNESS),
}


def invalidated_by(fault: CellError) -> tuple[str, ...]:
    """Kinds of calibrations that a fault makes worthless; mostly none."""
    return INVALIDATED_BY.get(type(fault), ())


async def invalidate_after(
    fault: CellError, folder: CalibrationFolder, archive: AsyncRunStore
) -> None:
    """Invalidate durably what a fault has made worthless.

    Raises ``CalibrationNotStored`` or ``RecordNotWritten``.
    """
    kinds = invalidated_by(fault)
    if not kinds:
        return
    reason = str(fault)
    found = await asyncio.to_thread(folder.invalidate, kinds, reason)
    names = [stored.kind for stored in found]
    _log.warning("calibrations invalidated", items=names, reason=reason)
    for stored in found:
        await archive.do(RunStore.invalidate_calibration, stored, reason)
    detail = {"items": names, "reason": reason}
    await archive.do(RunStore.audit, "cell", "calibrations invalidated", detail)
