"""The base of a robot in the large-field head (paper 2.1.2, fig. 2)."""

from collections.abc import Awaitable, Callable, Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np

from cellctl.calibration.arm_reference import ArmReference
from cellctl.calibration.solvers.base_frame.axis_fit import AxisStop
from cellctl.calibration.solvers.base_frame.base_frame import (
    ArmGeometry,
    BaseFrameResult,
    calibrate_base_frame,
)
from cellctl.calibration.store.kind import CalibrationKind
from cellctl.geometry.pose import Array
from cellctl.interfaces import Robot, TargetTracker
from cellctl.procedures.arm_reference import look_at_arm
from cellctl.procedures.input_forms import look_to_input
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome
from cellctl.workers import SOLVE_S, VisionWorkers

FLANGE_TARGETS = "F"
"""Targets on the flange have names that begin so."""


@dataclass(frozen=True, slots=True, eq=False)
class AxisTurns:
    """How axes A1 and A2 are turned, one after the other."""

    start_rad: Array
    """Joints, shape (6,): the middle of both arcs."""
    arc_deg: float
    stops: int
    speed_ratio: float
    """Speed of the turns as a share of rated joint speed."""
    frames: int
    """Exposures averaged at each stop."""
    target_prefix: str = FLANGE_TARGETS


async def calibrate_base(
    context: ProcedureContext,
    robot: Robot,
    tracker: TargetTracker,
    workers: VisionWorkers,
    *,
    turns: AxisTurns,
    arm: ArmGeometry,
    kind: CalibrationKind[BaseFrameResult],
    go_home: Callable[[], Awaitable[None]],
) -> ProcedureOutcome:
    """Turn A1 alone, then A2 alone, and measure the flange's targets at every stop.

    Begins with the robot at home and nothing in its way; each turn is entered from the middle of
    its arc.
    """
    motions = _Turner(context, robot, tracker, turns)
    # One axis at a time, because the line of an axis shows only while everything else is still.
    a1_looks = await motions.turn(0)
    a2_looks = await motions.turn(1)
    await motions.move(turns.start_rad)
    reference = await look_at_arm(
        robot, tracker, frames=turns.frames, target_prefix=turns.target_prefix
    )
    await go_home()
    await context.keep_input(
        {
            "arm": asdict(arm),
            "a1_stops": [look_to_input(stop) for stop in a1_looks],
            "a2_stops": [look_to_input(stop) for stop in a2_looks],
            "reference": look_to_input(reference),
        }
    )
    stops = axis_stops(a1_looks), axis_stops(a2_looks)
    found = await workers.run_within(SOLVE_S, calibrate_base_frame, *stops, arm)
    result = replace(found, reference=reference)
    # Loaded when it is drawn: checks of a cell file load this module for its moves.
    from cellctl.calibration.solvers.base_frame.base_frame_picture import base_frame_picture

    return ProcedureOutcome(
        kind=kind,
        record=result.to_record(),
        passed=result.passed,
        warnings=result.warnings,
        picture_png=await workers.run(base_frame_picture, result),
        serial_number=await tracker.serial_number(),
    )


@dataclass(frozen=True, slots=True)
class _Turner:
    context: ProcedureContext
    robot: Robot
    tracker: TargetTracker
    turns: AxisTurns

    async def turn(self, axis: int) -> list[ArmReference]:
        targets = turn_angles(self.turns, axis)
        # Back to the start first: while one axis turns, all others must stand where the start has
        # them.
        await self.move(self.turns.start_rad)
        looks = []
        for number, joints_rad in enumerate(targets, start=1):
            await self.context.progress(number, len(targets), f"axis A{axis + 1}: stop")
            await self.move(joints_rad)
            # The tracker also sees the targets of board and frame. They do not turn with the axis.
            # And the angles that the robot reports, not those that were commanded: it may have
            # stopped a little beside.
            look = await look_at_arm(
                self.robot,
                self.tracker,
                frames=self.turns.frames,
                target_prefix=self.turns.target_prefix,
            )
            looks.append(look)
        return looks

    async def move(self, joints_rad: Array) -> None:
        await self.robot.move_joint(joints_rad, speed_ratio=self.turns.speed_ratio)


def axis_stops(looks: Sequence[ArmReference]) -> list[AxisStop]:
    """What the solver takes of the looks at one turning axis."""
    return [AxisStop(look.joints_rad, look.targets) for look in looks]


def turn_angles(turns: AxisTurns, axis: int) -> list[Array]:
    """Joint targets: one axis over its arc around the start, the others still."""
    half_deg = turns.arc_deg / 2
    targets = []
    for offset in np.radians(np.linspace(-half_deg, half_deg, turns.stops)):
        joints_rad = turns.start_rad.copy()
        joints_rad[axis] += offset
        targets.append(joints_rad)
    return targets
