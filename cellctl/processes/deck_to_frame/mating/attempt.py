"""One attempt: the devices, the plan and the two things every phase does with them.

Those are a guarded move and a reading at standstill. Times are those of the event loop, which on
this platform are the same monotonic clock that stamps samples and poses.
"""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.cell.guarded_motion.contact_recorder import ContactRecorder
from cellctl.cell.guarded_motion.guard_port import GuardPort
from cellctl.cell.guarded_motion.guarded_moves import Motion, guarded
from cellctl.errors.force import SensorFrozen, SensorSilent
from cellctl.force.contact.compliance import NO_OFFSET, LateralOffset
from cellctl.geometry.pose import Array
from cellctl.guard.report import GuardTrip
from cellctl.interfaces import Robot
from cellctl.processes.deck_to_frame.mating.limits import fault_of
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan
from cellctl.processes.deck_to_frame.mating.result import (
    GivingWay,
    MatingPhase,
    MatingProgress,
    Reading,
)

POLL_S = 0.01
"""Pause between two looks at the newest sample; a reading does not end later by more than this."""
READING_TIMEOUT_S = 1.0
"""A sensor that has sent nothing for this time after the end of a reading is silent. The guard,
which stops the arm, notices it as soon as after ``stale_s``."""

Report = Callable[[MatingProgress], None]


@dataclass(slots=True)
class Attempt:
    """Devices and plan of one mating attempt."""

    robot: Robot
    guard: GuardPort
    plan: MatingPlan
    recorder: ContactRecorder
    report: Report
    offset: LateralOffset = NO_OFFSET
    """How far the deck has given way to pins."""
    gave_way: list[GivingWay] = field(default_factory=list)
    touches_above: int = 0
    """Touches above the window that giving way has ended."""
    places_tried: int = 0
    """Places that a search for the holes of pins has tried."""

    def pose_at(self, travel_m: float) -> RigidTransform:
        """Flange after ``travel_m`` along −Z_D, shifted where the deck gave way."""
        return self.plan.pose_at(travel_m, self.offset)

    def tell(self, phase: MatingPhase, reading: Reading | None = None, message: str = "") -> None:
        """Report progress."""
        travel_m = reading.travel_m if reading else self.recorder.travel_at(loop_time_s())
        force_n = reading.force_n if reading else float("nan")
        self.report(MatingProgress(phase, travel_m, force_n, message))

    async def move(self, motion: Motion) -> GuardTrip | None:
        """Run a robot move; None at its target, the trip when the guard stopped it."""
        return await guarded(self.robot, self.guard, motion)

    async def read(self, duration_s: float, settle_s: float = 0.0) -> Reading:
        """Mean wrench over ``duration_s`` at standstill, after ``settle_s`` of calming down.

        Raises the fault of a trip that happens meanwhile, ``SensorSilent`` or ``SensorFrozen``.
        """
        # By the clock of the samples and not by a sleep: what counts is when a sample was taken,
        # not when somebody looks at it.
        begin_s = loop_time_s() + settle_s
        end_s = begin_s + duration_s
        while self.guard.latest().time_s < end_s:
            self.raise_trip()
            if loop_time_s() > end_s + READING_TIMEOUT_S:
                raise SensorSilent(f"no sample for {READING_TIMEOUT_S:.1f} s while reading")
            await asyncio.sleep(POLL_S)
        self.raise_trip()
        curve = self.guard.samples(begin_s)
        # Samples that came while this waited are left out, so that every reading averages over the
        # same time.
        inside = curve.time_s <= end_s
        self.require_alive(curve.raw[inside])
        wrench = curve.wrench[inside]
        # The reported pose and not the commanded one: no move is exactly as long as commanded, and
        # the stiffness is taken from travel and force.
        travel_m = self.plan.travel_of(self.robot.state().base_T_flange)
        return Reading(end_s, travel_m, wrench.mean(axis=0), wrench.std(axis=0))

    def require_alive(self, raw: Array) -> None:
        """A live sensor is never still: raise ``SensorSilent`` or ``SensorFrozen``."""
        if len(raw) < 2:
            raise SensorSilent("no samples where there should be many")
        if not np.ptp(raw, axis=0).any():
            raise SensorFrozen(f"{len(raw)} samples in a row are equal in all six channels")

    def raise_trip(self) -> None:
        """Raise the fault of a latched trip, if there is one."""
        if self.guard.trip is not None:
            raise fault_of(self.guard.trip, self.plan.settings)


def loop_time_s() -> float:
    """Monotonic time of the running event loop."""
    return asyncio.get_running_loop().time()
