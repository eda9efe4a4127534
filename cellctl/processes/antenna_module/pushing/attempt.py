"""One insertion: devices, way and limits, and what every phase does with them."""

import asyncio
from dataclasses import dataclass

import numpy as np

from cellctl.cell.guarded_motion.contact_recorder import ContactRecorder
from cellctl.cell.guarded_motion.guard_limits import Sensing, guard_limits
from cellctl.cell.guarded_motion.guard_port import GuardPort
from cellctl.cell.guarded_motion.guarded_moves import Motion, guarded
from cellctl.clock import now_s
from cellctl.errors.force import SensorFrozen, SensorSilent
from cellctl.geometry.pose import Array
from cellctl.guard.limits import GuardLimits
from cellctl.guard.report import GuardTrip
from cellctl.interfaces import Robot
from cellctl.processes.antenna_module.connector.connector import Connector
from cellctl.processes.antenna_module.insertion.curve import InsertionCurve
from cellctl.processes.antenna_module.insertion.limits import InsertionLimits, PhaseLimits
from cellctl.processes.antenna_module.insertion.verdict import (
    InsertionJudgement,
    judge_insertion,
)
from cellctl.processes.antenna_module.insertion.watch import InsertionTrip, InsertionWatch
from cellctl.processes.antenna_module.pushing.way import InsertionWay

_POLL_S = 0.01
"""Pause between two looks at the newest sample; ten samples at 1 kHz."""
_LATE_S = 1.0
"""A sensor that is silent for this time beyond the end of a reading counts as lost."""
_LEAST_MOMENT_N_M = 0.1
"""Moment that is allowed however small the axial force is: noise and the hose of the gripper."""


@dataclass(slots=True)
class PushAttempt:
    """Devices and limits of one insertion."""

    robot: Robot
    guard: GuardPort
    sensing: Sensing
    way: InsertionWay
    socket: Connector
    limits: InsertionLimits
    watch: InsertionWatch
    recorder: ContactRecorder
    settle_s: float = 0.05
    """Time after which the arm has stopped swinging from a move of a tenth of a millimetre."""
    read_s: float = 0.1
    """Time over which a reading is averaged."""
    fed_s: float = -np.inf
    """Time of the last sample that the watch has seen."""

    async def arm(self, bounds: PhaseLimits) -> None:
        """Have the guard watch the limits of a phase; it stops the arm by itself."""
        # A resistance at the rim of the connector turns by half its length.
        lever_m = max(self.socket.outline_m) / 2.0
        moment_n_m = bounds.axial_n * lever_m + _LEAST_MOMENT_N_M
        # Infinite in a phase that bounds no turning moment.
        turn_n_m = min(bounds.moment_z_n_m, moment_n_m)
        side_n, axial_n = bounds.side_n, bounds.axial_n
        limits = (side_n, side_n, axial_n, moment_n_m, moment_n_m, turn_n_m)
        await self.guard.arm(guard_limits(limits, self.sensing))

    async def arm_with(self, limits: GuardLimits) -> None:
        """Have the guard watch other limits."""
        await self.guard.arm(limits)

    async def move(self, motion: Motion) -> GuardTrip | None:
        """Run a move of the arm; None at its target, the trip when the guard stopped it."""
        return await guarded(self.robot, self.guard, motion)

    @property
    def depth_m(self) -> float:
        """Where the flange is."""
        return self.way.depth_of(self.robot.state().base_T_flange)

    async def read(self) -> Array:
        """Mean wrench at standstill, shape (6,).

        Raises the fault of a trip that happens meanwhile, ``SensorSilent`` or ``SensorFrozen``.
        """
        begin_s = now_s() + self.settle_s
        end_s = begin_s + self.read_s
        # By the clock of the samples: what counts is when a sample was taken.
        while self.guard.latest().time_s < end_s:
            if self.guard.trip is not None:
                raise self.guard.trip.fault()
            if now_s() > end_s + _LATE_S:
                raise SensorSilent(f"no sample for {_LATE_S:.1f} s while reading")
            await asyncio.sleep(_POLL_S)
        samples = self.guard.samples(begin_s)
        if len(samples.raw) < 2:
            raise SensorSilent("no samples where there should be many")
        if not np.ptp(samples.raw, axis=0).any():
            raise SensorFrozen(f"{len(samples.raw)} samples in a row are equal")
        return np.asarray(samples.wrench.mean(axis=0))

    def feed_watch(self) -> InsertionTrip | None:
        """Show the watch every sample since the last call; the bound that was passed, if any."""
        # Every sample and not the newest: a peak between two moves is a contact as well.
        for sample in self.curve().after(self.fed_s):
            self.fed_s = sample.t_s
            self.watch.feed(sample)
        return self.watch.trip

    async def judged(self) -> InsertionJudgement:
        """The verdict of what was recorded so far."""
        # In a thread: a minute of samples takes a quarter of a second, and the robot has to hear
        # from the loop all the time.
        return await asyncio.to_thread(judge_insertion, self.curve(), self.socket, self.limits)

    def curve(self) -> InsertionCurve:
        """What was recorded so far, as far as the depth is known."""
        recorded = self.recorder.curve()
        # While the arm has not reported yet, nobody knows at which depth a sample was taken.
        known = np.isfinite(recorded.travel_m)
        wrench = recorded.wrench[known]
        return InsertionCurve(
            recorded.time_s[known], recorded.travel_m[known], wrench[:, :3], wrench[:, 3:]
        )
