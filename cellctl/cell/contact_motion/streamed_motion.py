"""Runs one motion in contact: a nominal path, what gives way on it, and what ends it."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from cellctl.cell.contact_motion.contact_loop import ContactLoop
from cellctl.cell.contact_motion.frames import displaced
from cellctl.cell.contact_motion.motions import ContactMotion, ContactSample, Ended
from cellctl.errors.streamed_contact import AdmittanceSaturated, ContactLost
from cellctl.force.contact.streamed.admittance import Admittance, PushRamp
from cellctl.force.contact.streamed.path import PathFollower
from cellctl.force.contact.streamed.speeds import ContactWatch
from cellctl.force.contact.streamed.ticks import Pace
from cellctl.geometry.pose import Array

_FREE_M = 0.5e-3
"""A press that moves so far without contact has lost it (d_free in section 4.2 of the study of
insertion by touch)."""
_SATURATED_S = 0.2
"""Two axes or more that stand at their bounds for so long are a fault (section 4.2)."""

End = Callable[[ContactSample], Ended | None]


@dataclass(frozen=True, slots=True, eq=False)
class Press:
    """What gives way, and what it pushes with."""

    admittance: Admittance
    ramp: PushRamp
    watch: ContactWatch | None = None
    """Watches the force along z, where losing the contact is a fault."""


@dataclass(slots=True, eq=False)
class StreamedMotion:
    """One motion. Begins at the setpoint that was sent last, at rest."""

    loop: ContactLoop
    path: PathFollower
    """The way of the nominal tip, points of shape (6,)."""
    speed: Callable[[ContactSample], float]
    """Speed along the path, in its unit; asked at every tick."""
    end: End
    limit_s: float
    press: Press | None = None
    _kept_m: float = field(default=0.0, init=False)
    """Displacement along z at the last tick with contact."""
    _saturated: int = field(default=0, init=False)
    """Ticks in a row with two axes or more at their bounds."""
    _braking: bool = field(default=False, init=False)

    async def run(self) -> ContactMotion:
        """Run until the end, and then until the setpoint stands; raises the faults of the
        contact."""
        samples: list[ContactSample] = []
        begun_s = self.loop.sample.time_s
        while True:
            sample = await self.loop.send(self._next(), self._at_bound())
            samples.append(sample)
            # The end comes before the limit and before the faults: where a motion has reached what
            # it was for, bounds that the same tick has met are no matter any more.
            ended = self.end(sample)
            if ended is None and sample.time_s - begun_s > self.limit_s:
                ended = Ended.TIME
            if ended is not None:
                break
            self._check(sample)
        while not self._stands():
            samples.append(await self.loop.send(self._pose(Pace.BRAKE), self._at_bound()))
        return ContactMotion(ended, tuple(samples))

    def _next(self) -> Array:
        # A motion that has begun to brake comes to a standstill before it goes on. Otherwise a
        # stream that is late again and again would make the arm jerk.
        self._braking = self.loop.pace is Pace.BRAKE or (self._braking and not self._stands())
        return self._pose(Pace.BRAKE if self._braking else self.loop.pace)

    def _pose(self, pace: Pace) -> Array:
        nominal = self._nominal(pace)
        if self.press is None:
            return nominal
        return displaced(nominal, self._displacement(self.press, pace))

    def _nominal(self, pace: Pace) -> Array:
        if pace is Pace.HOLD:
            return self.path.hold()
        if pace is Pace.BRAKE:
            return self.path.brake()
        return self.path.step(self.speed(self.loop.sample))

    def _displacement(self, press: Press, pace: Pace) -> Array:
        if pace is Pace.HOLD:
            return press.admittance.hold()
        if pace is Pace.BRAKE:
            return press.admittance.brake()
        return press.admittance.step(press.ramp.step(), self.loop.felt)

    def _at_bound(self) -> int:
        return 0 if self.press is None else int(self.press.admittance.at_bound.sum())

    def _stands(self) -> bool:
        moving = abs(self.path.speed)
        if self.press is not None:
            moving = max(moving, float(np.abs(self.press.admittance.velocity).max()))
        return moving < 1e-9  # m/s or rad/s: what braking leaves by rounding

    def _check(self, sample: ContactSample) -> None:
        if self.press is None:
            return
        admittance = self.press.admittance
        # One axis at its bound is an ordinary thing: it follows a face that ends nearby.
        self._saturated = self._saturated + 1 if self._at_bound() >= 2 else 0
        if self._saturated * self.loop.period_s > _SATURATED_S:
            given = ", ".join(f"{value:.4f}" for value in admittance.displacement)
            raise AdmittanceSaturated(f"displaced by ({given}) m, rad")
        if self.press.watch is None:
            return
        depth_m = float(admittance.displacement[2])
        # Counted from the last tick with contact, not from the beginning: a press may follow a face
        # that gives way as far as it is allowed to go at all.
        if not self.press.watch.lost(-float(sample.force_n[2])):
            self._kept_m = depth_m
        elif depth_m - self._kept_m > _FREE_M:
            moved_mm = (depth_m - self._kept_m) * 1e3
            raise ContactLost(f"{moved_mm:.2f} mm without the force that it pressed with")
