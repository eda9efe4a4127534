"""The rims of a part found by their edges, in the plane in which they must lie."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cellctl.errors.vision import HoleMissing, VisionError
from cellctl.geometry.pose import Array
from cellctl.vision.camera.plane_patch import X_AXIS
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.camera.triangulation import epipolar_distances_px, midpoints
from cellctl.vision.features.hole import Hole
from cellctl.vision.holes.correspondence import Expectation
from cellctl.vision.holes.plane_from_edges import plane_from_edges
from cellctl.vision.holes.plane_normal import possible_normals
from cellctl.vision.holes.search import HeadImages
from cellctl.vision.rim.roi import LocatedRim, RimRoi, locate_rim

LOCATE_REACH_PX = 7.0
"""Largest distance of a rim from its coarse place."""
_EPIPOLAR_PX = 2.5
"""Largest distance of two located rims of one hole from their epipolar line. Measured centres are
held to a seventh of it later (``measure``)."""
_MOST_PASSES, _SETTLED_M = 2, 1.5e-3
"""A second pass follows when the first has moved a hole by more than this: then the plane that the
first was made in may have been wrong by degrees."""


@dataclass(frozen=True, slots=True, eq=False)
class LocatedHoles:
    """All rims of a part in both images, to a fraction of a pixel."""

    places: Sequence[tuple[LocatedRim, LocatedRim]]
    """Left and right image of each hole."""
    positions_m: Array
    """Shape (n, 3), left camera."""
    normal: Array
    """Unit normal of the rims' planes, away from the head."""


def locate_holes(
    images: HeadImages,
    holes: Sequence[Hole],
    positions_m: Array,
    expectation: Expectation | None,
) -> LocatedHoles:
    """Locate the rims near ``positions_m`` (n, 3); raises ``HoleMissing`` when one has no edge.

    Where the drawing leaves the plane of the rims open, the rims decide.
    """
    for _ in range(_MOST_PASSES):
        normal, places = _in_best_plane(images, holes, positions_m, expectation)
        before_m, positions_m = positions_m, _positions(images.head, holes, places)
        # From a place that was far off, the plane was off as well, and with it the edges: the
        # rims are located again.
        if np.abs(positions_m - before_m).max() < _SETTLED_M:
            break
    normals = possible_normals(holes, positions_m, expectation)
    return LocatedHoles(places, positions_m, _closest(normal, normals))


def _in_best_plane(
    images: HeadImages,
    holes: Sequence[Hole],
    positions_m: Array,
    expectation: Expectation | None,
) -> tuple[Array, list[tuple[LocatedRim, LocatedRim]]]:
    """The normal for which the rims show most of their edges, and where they do."""
    # The positions are better than those that the choice was made with, and so is the plane they
    # span.
    normals = possible_normals(holes, positions_m, expectation)
    if not normals:
        normals = [_normal_by_rims(images, holes, positions_m)]
    found: list[tuple[Array, list[tuple[LocatedRim, LocatedRim]]]] = []
    faults: list[VisionError] = []
    # The edges decide: in a wrong plane a rim is no circle, and fewer of its azimuths agree on one.
    for normal in normals:
        try:
            found.append((normal, _locate(images, holes, positions_m, normal)))
        except VisionError as fault:
            faults.append(fault)
    if not found:
        raise faults[0]
    return max(found, key=_support)


def _support(found: tuple[Array, list[tuple[LocatedRim, LocatedRim]]]) -> float:
    return sum(left.support + right.support for left, right in found[1])


def _normal_by_rims(images: HeadImages, holes: Sequence[Hole], positions_m: Array) -> Array:
    middle = positions_m.mean(axis=0)
    forward = middle / np.linalg.norm(middle)
    rois = [
        rim_rois(images, hole, position_m, forward)
        for hole, position_m in zip(holes, positions_m, strict=True)
    ]
    normal = plane_from_edges(images.head, rois)
    if normal is None:
        names = ", ".join(hole.name for hole in holes)
        raise HoleMissing(f"{names}: the edges do not tell how the rim is tilted")
    return normal


def _closest(normal: Array, normals: Sequence[Array]) -> Array:
    """The possible normal nearest to ``normal``; ``normal`` itself where none are known."""
    return max(normals, key=lambda other: float(other @ normal), default=normal)


def _locate(
    images: HeadImages, holes: Sequence[Hole], positions_m: Array, normal: Array
) -> list[tuple[LocatedRim, LocatedRim]]:
    """Both images of every rim, located by their edges."""
    found = []
    for hole, position_m in zip(holes, positions_m, strict=True):
        left, right = rim_rois(images, hole, position_m, normal)
        found.append((locate_rim(left, LOCATE_REACH_PX), locate_rim(right, LOCATE_REACH_PX)))
    return found


def _positions(
    head: StereoHead, holes: Sequence[Hole], located: Sequence[tuple[LocatedRim, LocatedRim]]
) -> Array:
    left_px, right_px = (
        np.array([places[camera].point_px for places in located]) for camera in (0, 1)
    )
    distances = np.diag(epipolar_distances_px(head, left_px, right_px))
    for hole, distance in zip(holes, distances, strict=True):
        if distance > _EPIPOLAR_PX:
            raise HoleMissing(f"{hole.name}: left and right image disagree by {distance:.1f} px")
    return midpoints(head, left_px, right_px)


def rim_rois(
    images: HeadImages, hole: Hole, position_m: Array, normal: Array
) -> tuple[RimRoi, RimRoi]:
    """Regions of interest of a hole in both images; position and normal in the left camera."""
    head, turn = images.head, images.head.rotation
    in_right_m = turn @ position_m + head.translation_m
    return (
        RimRoi(hole, "left", images.left, head.left, position_m, normal, X_AXIS),
        RimRoi(hole, "right", images.right, head.right, in_right_m, turn @ normal, turn @ X_AXIS),
    )
