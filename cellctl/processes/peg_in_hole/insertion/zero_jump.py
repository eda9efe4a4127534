"""Detects a zero of the sensor that jumps during a feed: the force drops, but the tip stays.

Arm and contact are a spring, so the axial force can only fall as far as the tip goes back. If it
drops while the tip stands or goes on, the sensor has lost its zero, and the feed would push harder
by the drop. Two other sudden drops are real and left out: friction at two points of the walls that
lets go, which shows in side force and moment before, and a peg that slides down a chamfer, which is
why only depths between the walls count. Source: sensor_spike in section 5.2 of the study of
insertion by touch.
"""

from collections import deque
from collections.abc import Sequence

from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.processes.peg_in_hole.insertion.jam import rubbing_n
from cellctl.processes.peg_in_hole.verdict.judged_task import JudgedCell, JudgedTask

_LEAST_N = 3.0
"""A smaller drop may be friction that lets go."""
_LEAST_SIGMAS = 8.0
"""Noise makes no change of this many standard deviations."""
_WANDER_M = 5e-6
"""An arm may go back by this within some ticks without its encoders showing it."""
_SAMPLES = 4
"""Two before the jump and two after it: bandwidth and filter may spread it over a tick, and one
sample alone that is low is a spike."""


def most_dropped_n(cell: JudgedCell) -> float:
    """Greatest drop (N) that a good insertion may show."""
    return max(_LEAST_N, _LEAST_SIGMAS * cell.force_sigma_n, _WANDER_M * cell.stiffness_n_m)


class ZeroJump:
    """Takes the samples of one feed, and knows the greatest drop that no way back explains."""

    def __init__(self, task: JudgedTask) -> None:
        self._cell, self._fit, self._entry_m = task.cell, task.fit, task.fit.entry_depth_m
        self._latest: deque[tuple[float, float, float]] = deque(maxlen=_SAMPLES)
        """Depth, force against the feed, and the share of it that friction at the walls makes."""
        self.dropped_n = 0.0
        """Shown by two samples in a row."""

    def take(self, sample: ContactSample) -> bool:
        """Take the next sample; True when the force has dropped so far that its zero must have
        moved."""
        depth_m, axial_n = float(sample.task_position_tip_m[2]), -float(sample.force_n[2])
        if depth_m <= self._entry_m:
            self._latest.clear()
        # A tick that found no new force repeats the last one.
        elif not self._latest or axial_n != self._latest[-1][1]:
            self._latest.append(
                (depth_m, axial_n, rubbing_n(sample, self._fit, self._cell.friction))
            )
            if len(self._latest) == _SAMPLES:
                self.dropped_n = max(self.dropped_n, self._drop_n())
        return self.dropped_n > most_dropped_n(self._cell)

    def _drop_n(self) -> float:
        *before, one, other = self._latest
        return max(min(self._between_n(base, one), self._between_n(base, other)) for base in before)

    def _between_n(
        self, base: tuple[float, float, float], low: tuple[float, float, float]
    ) -> float:
        way_back_m = max(0.0, base[0] - low[0])
        return base[1] - low[1] - base[2] - self._cell.stiffness_n_m * way_back_m


def dropped_n(feed: Sequence[ContactSample], task: JudgedTask) -> float:
    """The greatest drop of the force in a feed, shown by two samples in a row."""
    watched = ZeroJump(task)
    for sample in feed:
        watched.take(sample)
    return watched.dropped_n
