"""A zero of the sensor that jumps in a feed: the force drops while the tip does not go back.

Arm and contact are a spring: the force along the axis falls by no more than the tip goes back. One
that drops at once while the tip stands or goes on has lost its zero, and the feed would push with
as much more as it has dropped. Friction at two points of the walls lets go all at once; it shows in
side force and moment before. Only depths between the walls count: on a chamfer a peg slides down
all at once. Source: sensor_spike in section 5.2 of the study of insertion by touch.
"""

from collections import deque
from collections.abc import Sequence

from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.processes.peg_in_hole.insertion.jam import rubbing_n
from cellctl.processes.peg_in_hole.verdict.judged_task import JudgedCell, JudgedTask

_LEAST_N = 3.0
"""A smaller drop is left to friction that lets go."""
_LEAST_SIGMAS = 8.0
"""A change by so many standard deviations is none of the noise."""
_WANDER_M = 5e-6
"""An arm may go back by so much within some ticks without a word from its encoders."""
_SAMPLES = 4
"""Two before the jump and two after it: bandwidth and filter may spread it over a tick, and one
sample alone that is low is a spike."""


def most_dropped_n(cell: JudgedCell) -> float:
    """A greater drop is none that a hole makes."""
    return max(_LEAST_N, _LEAST_SIGMAS * cell.force_sigma_n, _WANDER_M * cell.stiffness_n_m)


class ZeroJump:
    """Takes the samples of one feed, and knows the greatest drop that no way back explains."""

    def __init__(self, task: JudgedTask) -> None:
        self._cell, self._fit, self._entry_m = task.cell, task.fit, task.fit.entry_depth_m
        self._latest: deque[tuple[float, float, float]] = deque(maxlen=_SAMPLES)
        """Depth, force against the feed, and what of it friction at the walls makes."""
        self.dropped_n = 0.0
        """Shown by two samples in a row."""

    def take(self, sample: ContactSample) -> bool:
        """Take the next one; whether the force has dropped by so much that its zero is another."""
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
