"""The calibration kinds of this process.

To add one: define it here, write its procedure, and use its result in a step.
"""

from collections.abc import Mapping
from typing import Any

from cellctl.calibration.payload import IdentifiedPayload, payload_accepted
from cellctl.calibration.solvers.base_frame.base_frame import BaseFrameResult
from cellctl.calibration.solvers.stereo.stereo_result import StereoResult
from cellctl.calibration.solvers.transfer.board_transfer import TransferResult
from cellctl.calibration.store.kind import CalibrationKind
from cellctl.errors.force import ForceLimitExceeded, SensorSaturated
from cellctl.errors.robot import ArmOffReference, ControllerFault
from cellctl.errors.vision import HeadsMoved
from cellctl.processes.deck_to_frame.faults import CorrectionDiverging, MatingOverforce
from cellctl.processes.deck_to_frame.record_names import (
    BOARD_TRANSFER_NAME,
    CONTACT_STIFFNESS_NAME,
    HEAD_JOINTS,
    PAYLOAD_NAME,
    STOP_LATENCY_NAME,
)
from cellctl.processes.deck_to_frame.roles import FORCE, HEAD_1, HEAD_2

# A fault stands in ``invalidated_by`` when what caused it may have moved or bent something that
# the calibration holds for, or when the fault has proved a figure wrong. Faults with a likelier
# harmless cause do not: a bad part, or a jogged robot that returns to its place by its encoders.
# Who finds that a head was moved says so with ``cellctl calibrate invalidate``.


def _latency_s(record: Mapping[str, Any]) -> float:
    return float(record["upper_ms"]) / 1e3


def _stiffness_n_m(record: Mapping[str, Any]) -> float:
    return float(record["upper_n_per_mm"]) * 1e3


STEREO_HEAD_1 = CalibrationKind(
    name="head_1",
    parse=StereoResult.from_record,
    register="stereo",
    device=HEAD_1,
    procedures=(101,),
)
"""Cameras of stereo head I."""

STEREO_HEAD_2 = CalibrationKind(
    name="head_2",
    parse=StereoResult.from_record,
    register="stereo",
    device=HEAD_2,
    procedures=(102,),
)
"""Cameras of stereo head II."""

BASE_FRAME = CalibrationKind(
    name="base_frame",
    parse=BaseFrameResult.from_record,
    register="base_frame",
    # The arm, its mastering or the large-field head is another one than it was measured with.
    invalidated_by=frozenset({ArmOffReference}),
    procedures=(103,),
)
"""Base of the main robot in the large-field head."""

BOARD_TRANSFER = CalibrationKind(
    name=BOARD_TRANSFER_NAME,
    parse=TransferResult.from_record,
    register="board_transfer",
    invalidated_by=frozenset(
        {
            # A robot reports a collision as an error of its controller.
            ControllerFault,
            # The heads and the main robot no longer agree where things are.
            CorrectionDiverging,
            # Nor do the heads agree with each other.
            HeadsMoved,
            # The base that the boards were measured in is no longer there.
            ArmOffReference,
            # There was contact where none was expected: the deck may have met a head.
            ForceLimitExceeded,
        }
    ),
    holds_for=HEAD_JOINTS,
    procedures=(104, 105),
)
"""Both heads, at their measuring poses, in the base of the main robot."""

PAYLOAD = CalibrationKind(
    name=PAYLOAD_NAME,
    parse=IdentifiedPayload.from_record,
    register="payload",
    invalidated_by=frozenset(
        {
            ControllerFault,
            # Gripper, deck and sensor were loaded beyond what the plan allows.
            SensorSaturated,
            ForceLimitExceeded,
            # The figures with which the mating was planned were wrong.
            MatingOverforce,
        }
    ),
    device=FORCE,
    procedures=(106,),
    accepted=payload_accepted,
)
"""Gripper and deck on the force sensor."""

STOP_LATENCY = CalibrationKind(
    name=STOP_LATENCY_NAME,
    parse=_latency_s,
    invalidated_by=frozenset({MatingOverforce}),
    procedures=(107,),
    required=False,
)
"""Upper bound in s of the time that the main robot takes to stop."""

CONTACT_STIFFNESS = CalibrationKind(
    name=CONTACT_STIFFNESS_NAME,
    parse=_stiffness_n_m,
    invalidated_by=frozenset({MatingOverforce}),
    procedures=(108,),
    required=False,
    per_recipe=True,
)
"""Upper bound in N/m of arm and contact in series, with the parts of one recipe."""

CALIBRATIONS: tuple[CalibrationKind[Any], ...] = (
    STEREO_HEAD_1,
    STEREO_HEAD_2,
    BASE_FRAME,
    BOARD_TRANSFER,
    PAYLOAD,
    STOP_LATENCY,
    CONTACT_STIFFNESS,
)
