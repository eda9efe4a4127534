"""What a guard is told to watch, and how it is set up. Plain floats: no arrays in the guard."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from cellctl.force.contact.touch_detector import Cusum

if TYPE_CHECKING:
    from scipy.spatial.transform import RigidTransform

Six = tuple[float, float, float, float, float, float]
"""Fx, Fy, Fz in N, Mx, My, Mz in N·m."""

UNLIMITED: Six = (math.inf,) * 6

DEFAULT_FILTER_S = 5e-3
"""Time constant of the low-pass before the filtered limits.

A slower filter lets the force of a hard contact grow past its limit before the limit acts.
Simulated on a ramp of 1000 N/s, a limit of 35 N stopped at a true 40 N behind 5 ms and at 54 N
behind 20 ms.
"""

DEFAULT_RATE_WINDOW_S = 0.5
"""Time over which the sample rate is averaged. At 1 kHz it holds 500 samples, so a gap just short
of the default ``stale_s``, which is no fault, changes the rate by only 2 %."""

LONGEST_BRAKING_S = 4.0
"""Time from the request of a stop until what the robot carries hangs still. A large arm brakes from
1000 mm/s within two seconds, and its load swings on for as long."""


@dataclass(frozen=True, slots=True)
class CusumTouch(Cusum):
    """A touch detector on one component of the wrench."""

    axis: int = 2
    """Component of the wrench in the wrench frame, 0 … 5."""
    sign: float = 1.0
    """+1 when the contact pushes along the positive axis, −1 when against it."""


@dataclass(frozen=True, slots=True)
class GuardLimits:
    """Everything that trips while the guard is armed.

    ``raw`` and ``filtered`` are magnitudes in the wrench frame, N and N·m.
    """

    raw: Six = UNLIMITED
    """A single sample beyond it trips. It has to leave room for the noise of the sensor."""
    filtered: Six = UNLIMITED
    """The same after a first-order low-pass of ``filter_s``: noise averages out, so it can be
    tighter."""
    braking: Six | None = None
    """What ``raw`` and ``filtered`` may grow to while the robot brakes after a stop that the daemon
    has asked for, for ``LONGEST_BRAKING_S``; None where they stay as they are. A controller brakes
    harder than its moves accelerate, and the load that swings has touched nothing."""
    touch: CusumTouch | None = None
    filter_s: float = DEFAULT_FILTER_S
    stale_s: float = 0.01
    """No sample for this long trips: ten samples at 1 kHz. The approach speed is derived from it,
    since a force may grow unseen for so long (``ApproachFigures.delay_s``)."""
    flange_age_s: float = 0.1
    """A flange pose older than this trips: the gravity compensation would use a wrong direction.
    Controllers report every 20 ms, so five reports in a row are missing by then."""
    frozen_samples: int = 10
    """This many samples in a row with six equal values trip. At 1 kHz a sensor that has frozen is
    then noticed as soon as one that has fallen silent."""
    bad_frames: int = 3
    """This many damaged or unusable frames within ``bad_frames_window_s`` trip. A single one now
    and then is normal on a serial line; three in the 100 frames of a window are not."""
    bad_frames_window_s: float = 0.1
    rate_hz: tuple[float, float] = (0.0, math.inf)
    """Allowed sample rate, averaged over ``rate_window_s``."""
    rate_window_s: float = DEFAULT_RATE_WINDOW_S

    def __post_init__(self) -> None:
        # Written so that NaN is refused as well: a limit of NaN would never be compared as passed.
        thresholds = (*self.raw, *self.filtered, *(self.braking or ()))
        durations = (self.filter_s, self.stale_s, self.flange_age_s, self.rate_window_s)
        # A single sample is always equal to itself, so a count of one would trip at the first
        # sample.
        counts = (self.frozen_samples - 1, self.bad_frames)
        if not all(value > 0.0 for value in (*thresholds, *durations, *counts)):
            raise ValueError("guard limits are positive numbers; at least two frozen samples")


def _identity() -> RigidTransform:
    """Imported here: the guard process reads this module too and must not load arrays."""
    from scipy.spatial.transform import RigidTransform

    return RigidTransform.identity()


@dataclass(frozen=True, slots=True)
class GuardSettings:
    """How the guard process is set up, for its whole life."""

    flange_T_sensor: RigidTransform = field(default_factory=_identity)
    beat_s: float = 0.02
    """Interval of the heartbeat to the robot; at most a third of its dead man's time, so that one
    lost beat does not stop it."""
    stop_confirm_s: float = 0.1
    """When the robot has not latched a stop after this time, the guard withholds its heartbeat. The
    request was repeated at every beat until then, five times."""
    fifo_priority: int = 60
    """SCHED_FIFO priority; 0 leaves the scheduler alone. Any priority puts the guard before all
    ordinary processes, and that is what counts: docs/guard.md has the figures."""
    lock_memory: bool = True
    """Keep all memory of the guard out of swap."""
    cpu: int | None = None
    """Pin to this processor; None lets the scheduler choose, which measured no worse."""
    ring_slots: int = 131_072
    """Samples kept for the daemon: two minutes at 1 kHz. A power of two."""
    start_timeout_s: float = 20.0
    """Longest wait for sensor and stop channel. It only ends a driver that hangs: each driver has a
    shorter time-out of its own for its connection, and says then what it has waited for."""
    reply_timeout_s: float = 1.0
    """A guard that does not answer a request within this time counts as dead. It answers within one
    turn of its loop, which is a beat at most; the rest is for a PC that is busy."""
