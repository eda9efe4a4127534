"""Whether an arm still stands where its base frame was measured: one look at its targets."""

from collections.abc import Awaitable, Callable, Iterable, Iterator

from cellctl.calibration.arm_reference import (
    ArmReference,
    TargetOffset,
    require_arm_at_reference,
    target_offsets,
)
from cellctl.errors.robot import ArmReferenceMissing
from cellctl.geometry.pose import MM, Array
from cellctl.interfaces import Robot, TargetTracker
from cellctl.procedures.input_forms import look_to_input
from cellctl.records.entries import Figure
from cellctl.records.figures import Limit, figure
from cellctl.runtime.procedure import ProcedureContext


async def look_at_arm(
    robot: Robot, tracker: TargetTracker, *, frames: int, target_prefix: str
) -> ArmReference:
    """The targets of the arm where it stands, those whose names begin so."""
    seen = await tracker.measure(frames)
    # The joints that the robot reports, which the next look is compared at.
    joints_rad: Array = robot.state().joints_rad
    return ArmReference(
        joints_rad, tuple(target for target in seen if target.name.startswith(target_prefix))
    )


async def check_arm_reference(
    context: ProcedureContext,
    robot: Robot,
    tracker: TargetTracker,
    reference: ArmReference | None,
    *,
    speed_ratio: float,
    frames: int,
    target_prefix: str,
    go_home: Callable[[], Awaitable[None]],
) -> None:
    """Go to the place of the reference, look, go home, and compare.

    Begins with the robot at home and nothing in its way. Raises ``ArmOffReference``,
    ``ArmReferenceMissing`` and what robot and tracker raise.
    """
    if reference is None:
        raise ArmReferenceMissing("the base frame was measured without one")
    await context.progress(1, 1, "look")
    await robot.move_joint(reference.joints_rad, speed_ratio=speed_ratio)
    now = await look_at_arm(robot, tracker, frames=frames, target_prefix=target_prefix)
    await go_home()
    await context.keep_input({"then": look_to_input(reference), "now": look_to_input(now)})
    offsets = target_offsets(reference, now)
    # Before the verdict: by how much the arm is off belongs into the record of its run.
    if context.recorder:
        await context.recorder.figures(offset_figures(offsets))
    worst_m = require_arm_at_reference(offsets)
    context.board.update(message=f"all targets within {worst_m / MM:.3f} mm")


def offset_figures(offsets: Iterable[TargetOffset]) -> Iterator[Figure]:
    """How far each target is from its place."""
    for one in offsets:
        yield figure(
            f"target_offset.{one.name}",
            one.off_m / MM,
            "mm",
            label=f"distance of target {one.name} from its place",
            limit=Limit(upper=one.limit_m / MM),
        )
