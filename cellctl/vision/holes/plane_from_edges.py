"""The plane of rims from their own shape, when nothing else says how a part is turned.

That is so with one or two holes, or with all of them on a line, and no predicted pose. A circle of
known size seen by two cameras gives two ellipses; only one plane explains both.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.camera.lens import undistort
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.rim.edges import strongest_edges
from cellctl.vision.rim.roi import RimRoi

_REACH_PX = 8.0
"""Distance from the coarse place within which edges are looked for."""
_SQUEEZE = 0.25
"""Largest share of its diameter by which a tilted rim may look narrower."""
_STARTS = ((0.0, 0.0), (0.35, 0.0), (-0.35, 0.0), (0.0, 0.35), (0.0, -0.35))
"""Slopes against the line of sight. An ellipse nearly fits two opposite tilts, so the fit starts on
all sides and the best result counts."""
_SOFT_PX = 0.3
"""Distance from which on an edge point counts less: some belong to a wall or to a chamfer."""
_SIZE_SIGMA = 0.02
"""Standard deviation of a rim's size about the drawing's, relative."""
_FEWEST_EDGES = 24
"""Least number of edge points, in 64 directions. Fewer leave the tilt to chance."""
_UNKNOWNS = 4
"""Unknowns of each rim: a move in three directions and its growth, in radii."""


@dataclass(frozen=True, slots=True, eq=False)
class _Seen:
    """One rim: where it is thought to be, and its edge points in both cameras."""

    centre_m: Array
    radius_m: float
    rays: tuple[Array, Array]
    """Shape (n, 3) each, in the frame of the camera, z = 1."""


def plane_from_edges(head: StereoHead, rois: Sequence[tuple[RimRoi, RimRoi]]) -> Array | None:
    """Common unit normal of the rims, away from the left camera, in that camera, shape (3,).

    None when their edges do not tell. ``rois`` look at each hole with any plausible normal.
    """
    # Loaded by whoever fits, which in the daemon are its workers.
    from scipy.optimize import least_squares

    rims = []
    for left, right in rois:
        rays = _edge_rays(left), _edge_rays(right)
        if min(len(rays[0]), len(rays[1])) < _FEWEST_EDGES:
            return None
        rims.append(_Seen(left.centre_m, left.hole.diameter_m / 2.0, rays))
    problem = _PlaneProblem(head, rims)
    found = [
        least_squares(problem.residuals, problem.start(slopes), loss="soft_l1", f_scale=_SOFT_PX)
        for slopes in _STARTS
    ]
    return problem.normal(min(found, key=lambda one: float(one.cost)).x)


class _PlaneProblem:
    """Residuals of all edge points for two slopes of the plane and the unknowns of each rim."""

    def __init__(self, head: StereoHead, rims: Sequence[_Seen]) -> None:
        self._head, self._rims = head, rims
        middle = np.mean([rim.centre_m for rim in rims], axis=0)
        self._forward = middle / np.linalg.norm(middle)
        # Holes lie in front of the camera, so the line of sight is never along its y axis.
        first = np.cross(self._forward, [0.0, 1.0, 0.0])
        first /= np.linalg.norm(first)
        self._across = np.stack([first, np.cross(self._forward, first)])

    def start(self, slopes: tuple[float, float]) -> Array:
        return np.concatenate([slopes, np.zeros(_UNKNOWNS * len(self._rims))])

    def normal(self, vector: Array) -> Array:
        normal: Array = self._forward + vector[:2] @ self._across
        return np.asarray(normal / np.linalg.norm(normal))

    def residuals(self, vector: Array) -> Array:
        head, normal = self._head, self.normal(vector)
        rows = []
        for rim, move in zip(self._rims, vector[2:].reshape(-1, _UNKNOWNS), strict=True):
            centre_m = rim.centre_m + rim.radius_m * move[:3]
            radius_m = rim.radius_m * (1.0 + move[3])
            in_right_m = head.rotation @ centre_m + head.translation_m
            left_m = _off_circle_m(rim.rays[0], normal, centre_m, radius_m)
            right_m = _off_circle_m(rim.rays[1], head.rotation @ normal, in_right_m, radius_m)
            rows += [
                left_m * head.left.camera_matrix[0, 0] / centre_m[2],
                right_m * head.right.camera_matrix[0, 0] / in_right_m[2],
                # The size is known from the drawing. If it were free, a tilt and an oval rim could
                # trade with it.
                move[3:] / _SIZE_SIGMA,
            ]
        return np.concatenate(rows)


def _edge_rays(roi: RimRoi) -> Array:
    patch = roi.patch(_REACH_PX)
    if patch is None:
        return np.empty((0, 3))
    radius = roi.nominal_radius
    centre = patch.basis @ roi.centre_m / roi.distance_m
    reach = _REACH_PX * patch.unit_px + _SQUEEZE * radius
    edges = strongest_edges(roi.image, patch, centre, radius, reach, bright=roi.kind.bright)
    rays = undistort(roi.camera, patch.to_px(edges))
    return np.column_stack([rays, np.ones(len(rays))])


def _off_circle_m(rays: Array, normal: Array, centre_m: Array, radius_m: float) -> Array:
    """Distances of edge points from a circle, in its plane."""
    points = rays * (normal @ centre_m / (rays @ normal))[:, None]
    return np.asarray(np.linalg.norm(points - centre_m, axis=1) - radius_m)
