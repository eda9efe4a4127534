"""What the guard is told to watch, and how it is set up. Plain floats: no arrays in the guard."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scipy.spatial.transform import RigidTransform

Six = tuple[float, float, float, float, float, float]
"""Fx, Fy, Fz in N, Mx, My, Mz in N·m."""

UNLIMITED: Six = (math.inf,) * 6

DEFAULT_FILTER_S = 5e-3
"""A slower one lets hard contacts grow past the force limit before it notices them."""

DEFAULT_RATE_WINDOW_S = 0.5


@dataclass(frozen=True, slots=True)
class CusumTouch:
    """Touch: the sum of ``max(0, f − drift)`` over the samples exceeds a threshold."""

    drift_n: float = 4.0
    threshold_n: float = 120.0
    """Sum over samples, chosen for 1 kHz; another rate has another one."""
    axis: int = 2
    """Component of the deck-frame wrench, 0 … 5."""
    sign: float = 1.0
    """+1 when contact pushes along the positive axis; a deck is pushed up along z."""


@dataclass(frozen=True, slots=True)
class GuardLimits:
    """Everything that trips while the guard is armed. Magnitudes in the deck frame, N and N·m."""

    raw: Six = UNLIMITED
    """A single sample beyond it trips."""
    filtered: Six = UNLIMITED
    """The same after a first-order low-pass of ``filter_s``."""
    touch: CusumTouch | None = None
    filter_s: float = DEFAULT_FILTER_S
    stale_s: float = 0.01
    """No sample for this long trips."""
    flange_age_s: float = 0.1
    """A flange pose older than this trips."""
    frozen_samples: int = 10
    """So many samples in a row with six equal values trip."""
    bad_frames: int = 3
    """So many damaged or unusable frames within ``bad_frames_window_s`` trip."""
    bad_frames_window_s: float = 0.1
    rate_hz: tuple[float, float] = (0.0, math.inf)
    """Allowed sample rate, averaged over ``rate_window_s``."""
    rate_window_s: float = DEFAULT_RATE_WINDOW_S

    def __post_init__(self) -> None:
        thresholds = (*self.raw, *self.filtered)
        durations = (self.filter_s, self.stale_s, self.flange_age_s, self.rate_window_s)
        counts = (self.frozen_samples - 1, self.bad_frames)
        if not all(value > 0.0 for value in (*thresholds, *durations, *counts)):
            raise ValueError("guard limits are positive numbers; at least two frozen samples")


def _identity() -> RigidTransform:
    """Imported here, so that the guard, which reads this module too, stays free of arrays."""
    from scipy.spatial.transform import RigidTransform

    return RigidTransform.identity()


@dataclass(frozen=True, slots=True)
class GuardSettings:
    """How the guard process is set up, for its whole life."""

    flange_T_sensor: RigidTransform = field(default_factory=_identity)
    beat_s: float = 0.02
    """Interval of the heartbeat to the robot; at most a third of its dead man."""
    stop_confirm_s: float = 0.1
    """A stop that the robot has not latched by then makes the guard withhold its heartbeat."""
    fifo_priority: int = 60
    """SCHED_FIFO priority; 0 leaves the scheduler alone."""
    lock_memory: bool = True
    cpu: int | None = None
    """Pin to this processor; None lets the scheduler choose, which measured no worse."""
    ring_slots: int = 131_072
    """Samples kept for the daemon: two minutes at 1 kHz. A power of two."""
    start_timeout_s: float = 20.0
    reply_timeout_s: float = 1.0
