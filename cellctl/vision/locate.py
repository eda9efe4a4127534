"""The rims of a part found by their edges, in the plane in which they must lie."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from cellctl.errors.vision import HoleMissing, VisionError
from cellctl.geometry.pose import Array
from cellctl.vision.facing import possible_normals
from cellctl.vision.features import Hole
from cellctl.vision.layout import Expectation
from cellctl.vision.plane_patch import X_AXIS
from cellctl.vision.rim.sight import SIDES, Located, Rejection, Sight, locate_rim
from cellctl.vision.rim.tilt import measured_normal
from cellctl.vision.search import ImagePair
from cellctl.vision.stereo import epipolar_distances_px, midpoints
from cellctl.vision.stereo_head import StereoHead

LOCATE_REACH_PX = 7.0
"""How far from its coarse place a rim is found."""
_EPIPOLAR_PX = 2.5
_MOST_PASSES, _SETTLED_M = 2, 1.5e-3

_T = TypeVar("_T")


@dataclass(frozen=True, slots=True)
class LocatedHoles:
    """All rims of a part in both images, to a fraction of a pixel."""

    places: Sequence[tuple[Located, Located]]
    positions_m: Array
    """Shape (n, 3), left camera."""
    normal: Array
    """Unit normal of the rims' planes, away from the head."""


def locate_holes(
    pair: ImagePair,
    holes: Sequence[Hole],
    positions_m: Array,
    expectation: Expectation | None,
) -> LocatedHoles:
    """Locate the rims near ``positions_m`` (n, 3); raises ``HoleMissing`` when one has no edge.

    Where the drawing leaves the plane of the rims open, the rims decide.
    """
    for _ in range(_MOST_PASSES):
        normal, places = _facing(pair, holes, positions_m, expectation)
        before_m, positions_m = positions_m, _positions(pair.head, holes, places)
        # From a place far off the plane is off as well, and the edges are not yet what they seem.
        if np.abs(positions_m - before_m).max() < _SETTLED_M:
            break
    normals = possible_normals(holes, positions_m, expectation)
    return LocatedHoles(places, positions_m, _closest(normal, normals))


def _facing(
    pair: ImagePair,
    holes: Sequence[Hole],
    positions_m: Array,
    expectation: Expectation | None,
) -> tuple[Array, list[tuple[Located, Located]]]:
    """The normal for which the rims show most of their edges, and where they do."""
    normals = possible_normals(holes, positions_m, expectation)
    if not normals:
        normals = [_normal_by_rims(pair, holes, positions_m)]
    found: list[tuple[Array, list[tuple[Located, Located]]]] = []
    faults: list[VisionError] = []
    for normal in normals:
        try:
            found.append((normal, _locate(pair, holes, positions_m, normal)))
        except VisionError as fault:
            faults.append(fault)
    if not found:
        raise faults[0]
    return max(found, key=_support)


def _support(found: tuple[Array, list[tuple[Located, Located]]]) -> float:
    return sum(one.support + two.support for one, two in found[1])


def _normal_by_rims(pair: ImagePair, holes: Sequence[Hole], positions_m: Array) -> Array:
    middle = positions_m.mean(axis=0)
    forward = middle / np.linalg.norm(middle)
    sights = [sights_of(pair, position_m, forward) for position_m in positions_m]
    normal = measured_normal(pair.head, sights, holes)
    if normal is None:
        names = ", ".join(hole.name for hole in holes)
        raise HoleMissing(f"{names}: the edges do not tell how the rim is tilted")
    return normal


def _closest(normal: Array, normals: Sequence[Array]) -> Array:
    """Of the possible normals the one that was meant; the same where none are known."""
    return max(normals, key=lambda other: float(other @ normal), default=normal)


def _locate(
    pair: ImagePair, holes: Sequence[Hole], positions_m: Array, normal: Array
) -> list[tuple[Located, Located]]:
    """Both images of every rim, located by their edges."""
    found = []
    for hole, position_m in zip(holes, positions_m, strict=True):
        left, right = (
            or_missing(hole, locate_rim(sight, hole, LOCATE_REACH_PX), side)
            for side, sight in zip(SIDES, sights_of(pair, position_m, normal), strict=True)
        )
        found.append((left, right))
    return found


def _positions(
    head: StereoHead, holes: Sequence[Hole], located: Sequence[tuple[Located, Located]]
) -> Array:
    left_px, right_px = (
        np.array([places[camera].point_px for places in located]) for camera in (0, 1)
    )
    distances = np.diag(epipolar_distances_px(head, left_px, right_px))
    for hole, distance in zip(holes, distances, strict=True):
        if distance > _EPIPOLAR_PX:
            raise HoleMissing(f"{hole.name}: left and right image disagree by {distance:.1f} px")
    return midpoints(head, left_px, right_px)


def sights_of(pair: ImagePair, position_m: Array, normal: Array) -> tuple[Sight, Sight]:
    """Where both cameras see a hole; position and normal in the left camera."""
    head, turn = pair.head, pair.head.rotation
    in_right = turn @ position_m + head.translation_m
    return (
        Sight(pair.left, head.left, position_m, normal, X_AXIS),
        Sight(pair.right, head.right, in_right, turn @ normal, turn @ X_AXIS),
    )


def or_missing(hole: Hole, found: _T | Rejection, side: str = "") -> _T:
    """What was found, or ``HoleMissing`` with the reason."""
    if isinstance(found, Rejection):
        side = side or found.side
        raise HoleMissing(f"{hole.name}{side and f' ({side})'}: {found.reason}")
    return found
