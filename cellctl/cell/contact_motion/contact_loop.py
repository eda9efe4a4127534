"""One tick after the other: newest wrench and report in, next setpoint out."""

from collections.abc import Callable

import numpy as np

from cellctl.cell.contact_motion.frames import ContactFrames
from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.cell.contact_motion.settings import ContactSettings
from cellctl.cell.contact_motion.ticks import ContactTick, MotionKind, TickObserver
from cellctl.cell.contact_motion.trail import Trail
from cellctl.cell.guarded_motion.guard_port import GuardPort
from cellctl.cell.guarded_motion.guarded_moves import late_trip
from cellctl.clock import now_s
from cellctl.errors.robot import MotionAborted
from cellctl.force.contact.streamed.ticks import Pace, TickRules
from cellctl.force.contact.streamed.wrench_filter import WrenchFilter, left_of_noise
from cellctl.geometry.pose import Array
from cellctl.guard.report import TareResult
from cellctl.interfaces.streaming_robot import PoseStream, StreamReport

_LOOK_BACK_S = 0.05
"""Samples before the first tick that settle the filter: 25 of its time constants, which are 2 ms
unless somebody sets them otherwise."""


class ContactLoop:
    """The stream with the guard's wrenches beside it. Used by one motion at a time.

    The guard gives its wrenches in the frame of the tip, tared at standstill out of contact.
    """

    def __init__(
        self,
        stream: PoseStream,
        guard: GuardPort,
        tare: TareResult,
        frames: ContactFrames,
        *,
        settings: ContactSettings,
        observer: TickObserver,
        clock: Callable[[], float] = now_s,
    ) -> None:
        self.stream, self.settings, self.frames = stream, settings, frames
        self._guard, self._observer, self._clock = guard, observer, clock
        self._rules = TickRules(
            stream.period_s, settings.lost_tick_s, settings.old_force_s, settings.lost_force_s
        )
        self._filter = WrenchFilter(settings.filter_s)
        self._raw_sigma_n = float(np.sqrt(np.mean(tare.sigma[:3] ** 2)))
        self._report = stream.report
        self._force_sigma_n = self._raw_sigma_n
        self._take_wrenches()
        self.trail = Trail()
        self.tip_command: Array = frames.tip(self._report.base_T_flange)
        """Six numbers of the tip that were sent last."""
        self.pace = Pace.STEP
        """How the next setpoint is to follow."""
        self.sample = self._sample(self._report)
        self._motion, self._kind = 0, MotionKind.HOLD

    @property
    def period_s(self) -> float:
        """Period of the stream."""
        return self.stream.period_s

    @property
    def sent_s(self) -> float:
        """When the newest setpoint went out; on the clock of the forces."""
        return self._report.sent_s

    @property
    def force_s(self) -> float:
        """When the newest force that ``sample`` holds was measured."""
        return self._filter.time_s

    @property
    def felt(self) -> Array:
        """Filtered wrench on the peg about its tip, in the axes of the task, shape (6,)."""
        return np.concatenate([self.sample.force_n, self.sample.moment_n_m])

    def begin_motion(self, kind: MotionKind) -> None:
        """The ticks from now on belong to another motion."""
        self._motion, self._kind = self._motion + 1, kind

    async def send(self, tip: Array, at_bound: int = 0) -> ContactSample:
        """Send six numbers of the tip, wait for the tick, and take the newest wrench and report.

        ``at_bound`` says how many axes have given way as far as they may, for the record. Raises
        the fault of a guard that has tripped, ``StreamLate``, or what the stream raises.
        """
        # Asked on both sides of the wait for the tick: no setpoint follows a trip that is known,
        # and a trip that comes in during the wait ends the motion without another tick.
        self._raise_trip()
        try:
            report = await self.stream.advance(self.frames.base_T_flange(tip))
        except MotionAborted:
            # The robot may report the stop before the guard reports why it asked for it. The trip
            # is the cause, and the abort only its consequence.
            trip = await late_trip(self._guard)
            if trip is None:
                raise
            raise trip.fault() from None
        self._raise_trip()
        self._take_wrenches()
        age_s, self._report = report.time_s - self._report.time_s, report
        force_age_s = self._clock() - self._filter.time_s
        way_m = float(np.linalg.norm(tip[:3] - self.tip_command[:3]))
        self.tip_command = tip
        self.sample = self._sample(report)
        self.trail.note(tip)
        self.pace = self._rules.pace(age_s, force_age_s)
        self._observer.take(
            ContactTick(
                self.sample,
                tip,
                age_s,
                force_age_s,
                self.pace,
                report.late,
                self._motion,
                self._kind,
                at_bound,
                way_m / self.period_s,
            )
        )
        return self.sample

    def _raise_trip(self) -> None:
        if self._guard.trip is not None:
            raise self._guard.trip.fault()

    def _take_wrenches(self) -> None:
        since_s = max(self._filter.time_s, self._clock() - _LOOK_BACK_S)
        new = self._guard.samples(since_s)
        if len(new.time_s) > 1:
            sample_s = float(new.time_s[-1] - new.time_s[0]) / (len(new.time_s) - 1)
            self._force_sigma_n = self._raw_sigma_n * left_of_noise(
                self.settings.filter_s, sample_s
            )
        self._filter.take(new.time_s, new.wrench)

    def _sample(self, report: StreamReport) -> ContactSample:
        tip = self.frames.tip(report.base_T_flange)
        wrench = self.frames.in_task(tip, self._filter.value)
        return ContactSample(
            report.time_s, tip[:3], tip[3:], wrench[:3], wrench[3:], self._force_sigma_n
        )
