"""Which device has moved since the cell was taught, from what both cameras see of it.

Four places are compared with the taught ones, all in the axes of the base:

| moved | axis in camera II | marks beside the axis | plate in camera I | plate in camera II |
|---|---|---|---|---|
| camera II by d | −d | | | −d |
| gripper marks by d | | d | | |
| plate by d | | | d | d |
| camera I by d | | | −d | |
| what the robot reaches | d | | e | |

A device is named when its row explains all four within their noise.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.faults.calibration import (
    ArmMoved,
    FixedCameraMoved,
    FlangeCameraMoved,
    GripperMarksMoved,
    ReferenceMoved,
    ReferencePlateMoved,
)


@dataclass(frozen=True, slots=True, eq=False)
class ReferenceReading:
    """One reference check. Each is x and y in the axes of the base, m, shape (2,)."""

    axis_in_camera_2: Array
    marks_from_axis: Array
    plate_in_camera_1: Array
    plate_in_camera_2: Array
    sigma_m: float
    """Standard deviation of each of them, per axis."""

    def stacked(self) -> Array:
        """The numbers in the order of the table, shape (4, 2)."""
        return np.stack(
            [
                self.axis_in_camera_2,
                self.marks_from_axis,
                self.plate_in_camera_1,
                self.plate_in_camera_2,
            ]
        )


_ROWS: Mapping[type[ReferenceMoved], Array] = {
    FixedCameraMoved: np.array([[-1.0, 0.0, 0.0, -1.0]]),
    GripperMarksMoved: np.array([[0.0, 1.0, 0.0, 0.0]]),
    ReferencePlateMoved: np.array([[0.0, 0.0, 1.0, 1.0]]),
    FlangeCameraMoved: np.array([[0.0, 0.0, -1.0, 0.0]]),
    # The robot's error is another one at every place, so it explains two of them by two vectors.
    ArmMoved: np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]),
}
_MAX_CHI2 = 22.5
"""The most chi square, of six numbers, that a single device may leave unexplained: exceeded once in
1000."""
MOVED_M = 10e-6
"""A place that is farther from the taught one than this has moved. Four times the noise of a check
with eight angles, and half of what must be found."""
_DOUBT_M = 9e-6
"""A place that is farther off is looked at again: what has moved by 20 µm appears nearer than this
in two of 1000 checks with four looks."""
_MOST_LOOKS = 4
"""A check never takes more looks than this many times those that it began with."""
_CLEAR = 2.0
"""A place that is off by this multiple of the limit has moved: no further look would change
that."""
_SIGMAS = 4.5
"""A false alarm costs a calibration. Where nothing has moved, 2 of 2500 drawn checks exceed it."""
_DRIFTS = 3.0
"""A drift of the arm by warming is no fault within this many standard deviations: plans include
it."""


def furthest_m(taught: ReferenceReading, now: ReferenceReading) -> float:
    """How far the place is from its taught one that has moved most."""
    return float(np.linalg.norm(now.stacked() - taught.stacked(), axis=1).max())


def further_looks(
    taught: ReferenceReading, now: ReferenceReading, *, first: int, taken: int
) -> int:
    """How many more looks must tell a device that has moved from an arm that repeats badly.

    As many again as were ``taken``, twice at most after the ``first`` ones; 0 when it is decided. A
    place that is far off is looked at again once: one look may have been disturbed.
    """
    away_m = furthest_m(taught, now)
    decided = taken > first and away_m > _CLEAR * moved_limit_m(taught, now)
    if away_m <= _DOUBT_M or decided or taken >= _MOST_LOOKS * first:
        return 0
    return taken


def moved_limit_m(taught: ReferenceReading, now: ReferenceReading) -> float:
    """How far a place may be: beyond it is more than noise."""
    return max(MOVED_M, _SIGMAS * float(np.hypot(taught.sigma_m, now.sigma_m)))


def require_nothing_moved(
    taught: ReferenceReading, now: ReferenceReading, arm_drift_m: float
) -> ArmMoved | None:
    """As ``require_reference``, but an arm that has only warmed up is given back as a warning.

    ``arm_drift_m``: standard deviation, per axis, of what warming moves one place against another.
    """
    try:
        require_reference(taught, now, moved_limit_m(taught, now))
    except ArmMoved as fault:
        if furthest_m(taught, now) > _DRIFTS * arm_drift_m:
            raise
        return fault
    return None


def require_reference(
    taught: ReferenceReading, now: ReferenceReading, limit_m: float = MOVED_M
) -> None:
    """Raise the fault of the device that moved; ``ReferenceMoved`` when none explains it alone."""
    deltas = now.stacked() - taught.stacked()
    if np.linalg.norm(deltas, axis=1).max() <= limit_m:
        return
    variance = taught.sigma_m**2 + now.sigma_m**2
    words = "axis in camera II {}, marks {}, plate in camera I {}, in camera II {} µm".format(
        *(f"({x * 1e6:.0f}, {y * 1e6:.0f})" for x, y in deltas)
    )
    # One vector explains before two do, so the robot is asked last.
    single = {fault: row for fault, row in _ROWS.items() if len(row) == 1}
    unexplained = {fault: _chi2(deltas, row) / variance for fault, row in single.items()}
    best = min(unexplained, key=lambda fault: unexplained[fault])
    if unexplained[best] <= _MAX_CHI2:
        raise best(words)
    if _chi2(deltas, _ROWS[ArmMoved]) / variance <= _MAX_CHI2:
        raise ArmMoved(words)
    raise ReferenceMoved(words)


def _chi2(deltas: Array, row: Array) -> float:
    """Squares that remain when the displacements of a row are fitted, m²."""
    explained = row.T @ np.linalg.lstsq(row.T, deltas, rcond=None)[0]
    return float(((deltas - explained) ** 2).sum())
