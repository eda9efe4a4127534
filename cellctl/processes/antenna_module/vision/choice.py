"""Which placement of a drawing is the right one, and the fault when none is for certain."""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import MM, Array
from cellctl.processes.antenna_module.connector.arrangement import MIRROR
from cellctl.processes.antenna_module.faults.connector import (
    ConnectorAmbiguous,
    ConnectorMisplaced,
    ConnectorTurned,
    ImageMirrored,
)
from cellctl.processes.antenna_module.vision.matching import Placement, placements
from cellctl.processes.antenna_module.vision.pattern import Candidates, Pattern

_NO_NOISE, _CLEARLY = 3.0, 3.0
"""Misfit over the standard deviation of good features, and over that in a mirror, from which on a
drawing is not the one that is seen."""


@dataclass(frozen=True, slots=True, eq=False)
class PlanarExpectation:
    """Where a drawing's origin is expected in the plane."""

    shift_m: Array
    yaw_rad: float
    within_m: float
    within_rad: float

    def turn_rad(self, placement: Placement) -> float:
        """Angle from the expected yaw, between -π and π."""
        return float((placement.yaw_rad - self.yaw_rad + np.pi) % (2.0 * np.pi) - np.pi)

    def holds(self, placement: Placement) -> bool:
        """Whether a placement is where it is expected."""
        return (
            abs(self.turn_rad(placement)) <= self.within_rad
            and self.distance_m(placement) <= self.within_m
        )

    def distance_m(self, placement: Placement) -> float:
        """How far a placement is from there."""
        return float(np.linalg.norm(placement.shift_m - self.shift_m))


def choose(
    candidates: Candidates, expected: PlanarExpectation | None, *, chiral: bool
) -> Placement:
    """The placement that most features agree with; there must be one at least.

    ``chiral``: the drawing differs from its mirror image, so that the number of features on spots
    tells a mirrored image. Of placements with equal numbers the expected place decides. Raises
    ``ImageMirrored``, ``ConnectorAmbiguous``, ``ConnectorTurned`` or ``ConnectorMisplaced``.
    """
    best = candidates.placements[0] if candidates.placements else None
    seen = candidates.mirrored[0].found if candidates.mirrored else 0
    if chiral and candidates.mirrored and seen > (0 if best is None else best.found):
        raise _mirrored(candidates.mirrored[0], best)
    if best is None:
        raise ConnectorAmbiguous("no placement")
    equal = [item for item in candidates.placements if item.found == best.found]
    if chiral and seen == best.found:
        raise ConnectorAmbiguous(f"{seen} features fit the drawing and its mirror image")
    if expected is None:
        if len(equal) > 1:
            raise ConnectorAmbiguous(_ways(equal, best))
        return best
    there = [item for item in equal if expected.holds(item)]
    if len(there) > 1:
        raise ConnectorAmbiguous(_ways(there, there[0]))
    if there:
        return there[0]
    if abs(expected.turn_rad(best)) > np.pi / 2.0:
        raise ConnectorTurned(
            f"{np.degrees(expected.turn_rad(best)):+.1f}° from where it should be"
        )
    raise ConnectorMisplaced(
        f"{expected.distance_m(best) / MM:.2f} mm and "
        f"{np.degrees(expected.turn_rad(best)):+.2f}° from where it should be, permitted are "
        f"{expected.within_m / MM:g} mm and {np.degrees(expected.within_rad):g}°"
    )


def refuse_mirrored(pattern: Pattern, candidates: Candidates, least: int) -> None:
    """Raise ``ImageMirrored`` where the spots fit the pattern clearly better in a mirror.

    For a pattern that nobody has proved to differ from its mirror image: one that looks the same
    there fits the spots as well in either form, and never better.
    """
    best = candidates.placements[0] if candidates.placements else None
    off_m = _NO_NOISE * pattern.true_position_m
    if best is not None and best.found == len(pattern.names) and best.misfit_m <= off_m:
        return
    if len(candidates.spots_m) < least:
        return
    in_mirror = placements(
        pattern.positions_m @ MIRROR, candidates.spots_m, least=least, reach_m=pattern.reach_m
    )
    if not in_mirror:
        return
    seen = in_mirror[0]
    if best is None or seen.found > best.found:
        raise _mirrored(seen, best)
    if seen.found == best.found and best.misfit_m > max(off_m, _CLEARLY * seen.misfit_m):
        raise _mirrored(seen, best)


def _mirrored(seen: Placement, best: Placement | None) -> ImageMirrored:
    drawn = "none" if best is None else f"{best.found} to {best.misfit_m / MM:.3f} mm"
    return ImageMirrored(
        f"{seen.found} of {len(seen.spot)} features fit the drawing in a mirror to "
        f"{seen.misfit_m / MM:.3f} mm, as drawn {drawn}"
    )


def _ways(equal: list[Placement], best: Placement) -> str:
    turns = ", ".join(
        f"{np.degrees(item.yaw_rad):.1f}° at "
        f"{item.shift_m[0] / MM:.2f}, {item.shift_m[1] / MM:.2f} mm"
        for item in equal
    )
    return f"{best.found} features fit at {turns}"
