"""When each arm moved since a moment, and how far it truly came: what no device of the cell knows.

For whoever injects a fault and has to say how long and how far the arms went on.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from fakes.world.frames import MM, Array
from fakes.world.robot import RobotArm


@dataclass(slots=True)
class Motion:
    """A motion lasts from one standstill to the next. Times are seconds of the world since the
    watch began."""

    begun_s: float
    """0 for a motion that was under way when the watch began."""
    ended_s: float | None = None
    """None while it goes on."""
    travel_mm: float = 0.0
    """Length of the way of the flange."""
    rise_mm: float = 0.0
    """How much higher the flange stands at the end, along z of the cell."""
    turn_deg: float = 0.0
    """Sum of all turns of the flange."""


class MotionWatch:
    """Follows arms from ``begin`` on, as finely as ``sample`` is called."""

    def __init__(self, arms: Mapping[str, RobotArm]) -> None:
        self._arms = arms
        self._tracks: dict[str, _Track] = {}
        self._begun_s = 0.0

    def begin(self, time_s: float) -> None:
        """Watch from this time of the world on, and forget an earlier watch."""
        self._begun_s = time_s
        self._tracks = {name: _Track(arm, time_s) for name, arm in self._arms.items()}

    def sample(self, time_s: float) -> None:
        """Take over what has happened up to this time; does nothing before the first ``begin``."""
        for track in self._tracks.values():
            track.sample(time_s)

    def report(self, time_s: float) -> dict[str, Any]:
        """Time since the watch began and the motions of every arm, as JSON values."""
        self.sample(time_s)
        return {
            "watched_s": time_s - self._begun_s,
            "motions": {
                name: [asdict(motion) for motion in track.motions]
                for name, track in self._tracks.items()
            },
        }


class _Track:
    """One arm."""

    def __init__(self, arm: RobotArm, time_s: float) -> None:
        self.motions: list[Motion] = []
        self._arm, self._begun_s = arm, time_s
        self._flange = arm.flange_matrix(time_s)

    def sample(self, time_s: float) -> None:
        """An arm that stands costs nothing."""
        open_motion = self.motions[-1] if self.motions and not self.motions[-1].ended_s else None
        moving = self._arm.moving(time_s)
        if open_motion is None and not moving:
            return
        if open_motion is None:
            open_motion = Motion(time_s - self._begun_s)
            self.motions.append(open_motion)
        self._follow(open_motion, self._arm.flange_matrix(time_s))
        if not moving:
            # The arm knows its standstill exactly; the sample comes up to a turn of the loop later.
            ended_s = min(self._arm.standstill_s, time_s) - self._begun_s
            open_motion.ended_s = max(ended_s, open_motion.begun_s)

    def _follow(self, motion: Motion, flange: Array) -> None:
        step_m = flange[:3, 3] - self._flange[:3, 3]
        # Small turns from the skew part: the trace is blind below 1e-8.
        turn = flange[:3, :3] @ self._flange[:3, :3].T
        axis = 0.5 * np.array(
            [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
        )
        motion.travel_mm += float(np.linalg.norm(step_m)) / MM
        motion.rise_mm += float(step_m[2]) / MM
        motion.turn_deg += float(np.rad2deg(np.arcsin(min(1.0, float(np.linalg.norm(axis))))))
        self._flange = flange
