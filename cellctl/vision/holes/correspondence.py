"""Which round feature is which hole: size, mutual distances and, if known, where to expect it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.camera.triangulation import epipolar_distances_px, midpoints
from cellctl.vision.features.hole import Hole
from cellctl.vision.features.kinds import kind_of
from cellctl.vision.holes.candidates import Candidate
from cellctl.vision.registration.rigid_fit import kabsch, misfits_m, on_a_line

_MAX_ASSIGNMENTS = 64
_SIZE_TOLERANCE = 0.3


@dataclass(frozen=True, slots=True)
class Expectation:
    """Where a part should be."""

    camera_T_part: RigidTransform
    """In the left camera."""
    radius_m: float
    """How far a hole may be from where this pose puts it."""


@dataclass(frozen=True, slots=True)
class StereoCandidate:
    """A round feature seen by both cameras, coarsely located."""

    position_m: Array
    """Shape (3,), left camera."""
    diameter_m: float
    left: Candidate
    right: Candidate
    bright: bool


@dataclass(frozen=True, slots=True)
class Assignment:
    """One way to give every hole a spot."""

    spots: tuple[StereoCandidate, ...]
    """In the order of the holes."""
    misfit_m: float
    """Largest distance of a spot from the fitted layout."""

    @property
    def positions_m(self) -> Array:
        """Shape (n, 3)."""
        return np.array([spot.position_m for spot in self.spots])

    @property
    def places_px(self) -> Array:
        """Coarse places in both images, left first, shape (n, 2, 2)."""
        return np.array([[spot.left.centre_px, spot.right.centre_px] for spot in self.spots])


def pair_spots(
    head: StereoHead,
    left: Sequence[Candidate],
    right: Sequence[Candidate],
    *,
    bright: bool,
    epipolar_px: float,
    depth_m: tuple[float, float],
) -> list[StereoCandidate]:
    """All left-right pairs that agree in epipolar geometry, depth and size."""
    if not left or not right:
        return []
    left_px = np.array([item.centre_px for item in left])
    right_px = np.array([item.centre_px for item in right])
    close = epipolar_distances_px(head, left_px, right_px) < epipolar_px
    rows, columns = np.nonzero(close)
    if len(rows) == 0:
        return []
    points = midpoints(head, left_px[rows], right_px[columns])
    in_right = points @ head.rotation.T + head.translation_m
    left_m = 2.0 * points[:, 2] / head.left.camera_matrix[0, 0]
    right_m = 2.0 * in_right[:, 2] / head.right.camera_matrix[0, 0]
    left_m = left_m * np.array([item.radius_px for item in left])[rows]
    right_m = right_m * np.array([item.radius_px for item in right])[columns]
    good = (points[:, 2] > depth_m[0]) & (points[:, 2] < depth_m[1]) & (in_right[:, 2] > 0)
    good &= np.abs(left_m - right_m) < _SIZE_TOLERANCE * np.maximum(left_m, right_m)
    return [
        StereoCandidate(
            points[index],
            float(left_m[index] + right_m[index]) / 2.0,
            left[rows[index]],
            right[columns[index]],
            bright,
        )
        for index in np.nonzero(good)[0]
    ]


def assignments(
    holes: Sequence[Hole],
    spots: Sequence[StereoCandidate],
    *,
    tolerance_m: float,
    expectation: Expectation | None,
) -> list[Assignment]:
    """Every assignment of distinct spots to all holes that fits the drawing, best first."""
    nominal = np.array([hole.position_m for hole in holes])
    choices = [_choices(hole, spots, expectation) for hole in holes]
    order = sorted(range(len(holes)), key=lambda index: len(choices[index]))
    wanted = np.linalg.norm(nominal[:, None] - nominal[None], axis=2)
    found = []
    for chosen in _consistent(order, choices, spots, wanted, 2.0 * tolerance_m):
        assignment = _checked(holes, [spots[index] for index in chosen], tolerance_m)
        if assignment is not None:
            found.append(assignment)
        if len(found) >= _MAX_ASSIGNMENTS:
            break
    return sorted(found, key=lambda item: item.misfit_m)


def holes_without_spot(
    holes: Sequence[Hole], spots: Sequence[StereoCandidate], expectation: Expectation | None
) -> list[str]:
    """Names of holes for which nothing of the right kind and size was seen at all."""
    return [hole.name for hole in holes if not _choices(hole, spots, expectation)]


def _choices(
    hole: Hole, spots: Sequence[StereoCandidate], expectation: Expectation | None
) -> list[int]:
    indices = [
        index
        for index, spot in enumerate(spots)
        if spot.bright == kind_of(hole).bright
        and abs(spot.diameter_m / hole.diameter_m - 1.0) < _SIZE_TOLERANCE
    ]
    if expectation is None:
        return indices
    expected = expectation.camera_T_part.apply(hole.position_m)
    return [
        index
        for index in indices
        if np.linalg.norm(spots[index].position_m - expected) < expectation.radius_m
    ]


def _consistent(
    order: Sequence[int],
    choices: Sequence[Sequence[int]],
    spots: Sequence[StereoCandidate],
    wanted: Array,
    tolerance_m: float,
) -> Iterator[list[int]]:
    """Depth-first search over spots whose mutual distances agree with the drawing."""
    positions = np.array([spot.position_m for spot in spots]).reshape(-1, 3)
    chosen = [-1] * len(order)

    def extend(depth: int) -> Iterator[list[int]]:
        if depth == len(order):
            yield list(chosen)
            return
        hole = order[depth]
        for spot in choices[hole]:
            if all(
                spot != chosen[other]
                and abs(
                    float(np.linalg.norm(positions[spot] - positions[chosen[other]]))
                    - wanted[hole, other]
                )
                < tolerance_m
                for other in order[:depth]
            ):
                chosen[hole] = spot
                yield from extend(depth + 1)
                chosen[hole] = -1

    yield from extend(0)


def _checked(
    holes: Sequence[Hole], spots: Sequence[StereoCandidate], tolerance_m: float
) -> Assignment | None:
    """The assignment, unless its layout is off or a face that is known would look away."""
    nominal = np.array([hole.position_m for hole in holes])
    measured = np.array([spot.position_m for spot in spots])
    if on_a_line(nominal):
        return Assignment(tuple(spots), 0.0)
    misfit_m = float(misfits_m(nominal, measured).max())
    if misfit_m > tolerance_m:
        return None
    outward = holes[0].outward
    if outward is not None and kabsch(nominal, measured)[0] @ outward @ measured.mean(axis=0) >= 0:
        return None
    return Assignment(tuple(spots), misfit_m)
