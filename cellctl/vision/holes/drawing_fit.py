"""Tests that measured holes fit their drawing, and that only one arrangement of them does."""

from collections.abc import Sequence

import numpy as np

from cellctl.errors.vision import HoleAmbiguous, ResidualsTooLarge
from cellctl.geometry.pose import MM, Array
from cellctl.vision.features.hole import Hole
from cellctl.vision.measurement import PairMeasurement
from cellctl.vision.registration.rigid_fit import misfits_m, on_a_line

_APART_M = 0.5e-3
"""Two measurements of a hole that are farther apart than this are of different features."""
_RIVAL_M = 0.15e-3
"""Another arrangement is as good when it fits the drawing within this of the best: well above what
measuring adds, as large as holes are off their drawing."""


def only_one(holes: Sequence[Hole], measured: Sequence[PairMeasurement]) -> PairMeasurement:
    """The arrangement that fits best; raises ``HoleAmbiguous`` when another fits as well."""
    off_m = [float(_off_drawing_m(holes, item.positions_m).max()) for item in measured]
    best = int(np.argmin(off_m))
    for other, other_m in zip(measured, off_m, strict=True):
        if other_m < off_m[best] + _RIVAL_M:
            _refuse_ambiguity(measured[best], other)
    return measured[best]


def check_layout(holes: Sequence[Hole], positions_m: Array, tolerance_m: float) -> None:
    """Raise ``ResidualsTooLarge`` when a hole is farther from its place on the drawing."""
    misfits = _off_drawing_m(holes, positions_m)
    worst = int(np.argmax(misfits))
    if misfits[worst] > tolerance_m:
        raise ResidualsTooLarge(
            f"{holes[worst].name} is {misfits[worst] / MM:.3f} mm off the drawing, "
            f"allowed {tolerance_m / MM:.3f} mm"
        )


def _off_drawing_m(holes: Sequence[Hole], positions_m: Array) -> Array:
    """Distance of each hole from where the others put it on the drawing, shape (n,)."""
    nominal = np.array([hole.position_m for hole in holes])
    if on_a_line(nominal):
        wanted = np.linalg.norm(nominal - nominal[0], axis=1)
        have = np.linalg.norm(positions_m - positions_m[0], axis=1)
        return np.asarray(np.abs(have - wanted))
    return misfits_m(nominal, positions_m)


def _refuse_ambiguity(first: PairMeasurement, other: PairMeasurement) -> None:
    for one, two in zip(first.holes, other.holes, strict=True):
        distance_m = float(np.linalg.norm(one.position_m - two.position_m))
        if distance_m > _APART_M:
            raise HoleAmbiguous(
                f"{one.name} could be either of two features {distance_m / MM:.1f} mm apart"
            )
