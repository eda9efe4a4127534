"""Which round feature is which hole: by size, mutual distances and, if known, expected place."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.camera.triangulation import epipolar_distances_px, midpoints
from cellctl.vision.features.hole import Hole
from cellctl.vision.features.known_kinds import kind_of
from cellctl.vision.holes.candidates import Candidate
from cellctl.vision.registration.rigid_fit import kabsch, misfits_m, on_a_line

_MAX_ASSIGNMENTS = 64
"""Most assignments that are looked at: where there are more, the drawing does not tell the features
apart."""
_SIZE_TOLERANCE = 0.3
"""Largest relative difference of sizes. Voting at reduced scale finds a radius to a tenth, and the
rim of a chamfer or a cone may win over the one that is meant."""


@dataclass(frozen=True, slots=True)
class Expectation:
    """The expected pose of a part."""

    camera_T_part: RigidTransform
    """Pose of the part in the left camera."""
    radius_m: float
    """Largest distance of a hole from where this pose puts it."""


@dataclass(frozen=True, slots=True, eq=False)
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
    """One way to assign a feature to every hole."""

    candidates: tuple[StereoCandidate, ...]
    """The candidates in the order of the holes."""
    misfit_m: float
    """Largest distance of a candidate from the fitted layout."""

    @property
    def positions_m(self) -> Array:
        """Shape (n, 3)."""
        return np.array([candidate.position_m for candidate in self.candidates])

    @property
    def places_px(self) -> Array:
        """Coarse places in both images, left first, shape (n, 2, 2)."""
        return np.array(
            [[candidate.left.centre_px, candidate.right.centre_px] for candidate in self.candidates]
        )


def pair_candidates(
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
    # Sizes are compared in metres, each with the depth of its own camera: in pixels the nearer
    # camera of a converging pair sees the larger circle.
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
    candidates: Sequence[StereoCandidate],
    *,
    tolerance_m: float,
    expectation: Expectation | None,
) -> list[Assignment]:
    """Every assignment of distinct candidates to all holes that fits the drawing, best first."""
    nominal = np.array([hole.position_m for hole in holes])
    choices = [_choices(hole, candidates, expectation) for hole in holes]
    # The hole with the fewest choices comes first: the search tree is then the smallest.
    order = sorted(range(len(holes)), key=lambda index: len(choices[index]))
    wanted = np.linalg.norm(nominal[:, None] - nominal[None], axis=2)
    found = []
    # Twice the tolerance, because both ends of a distance may be off by it.
    for chosen in _consistent(order, choices, candidates, wanted, 2.0 * tolerance_m):
        assignment = _checked(holes, [candidates[index] for index in chosen], tolerance_m)
        if assignment is not None:
            found.append(assignment)
        if len(found) >= _MAX_ASSIGNMENTS:
            break
    return sorted(found, key=lambda item: item.misfit_m)


def holes_without_candidate(
    holes: Sequence[Hole], candidates: Sequence[StereoCandidate], expectation: Expectation | None
) -> list[str]:
    """Names of holes for which nothing of the right kind and size was seen at all."""
    return [hole.name for hole in holes if not _choices(hole, candidates, expectation)]


def _choices(
    hole: Hole, candidates: Sequence[StereoCandidate], expectation: Expectation | None
) -> list[int]:
    indices = [
        index
        for index, candidate in enumerate(candidates)
        if candidate.bright == kind_of(hole).bright
        and abs(candidate.diameter_m / hole.diameter_m - 1.0) < _SIZE_TOLERANCE
    ]
    if expectation is None:
        return indices
    expected = expectation.camera_T_part.apply(hole.position_m)
    return [
        index
        for index in indices
        if np.linalg.norm(candidates[index].position_m - expected) < expectation.radius_m
    ]


def _consistent(
    order: Sequence[int],
    choices: Sequence[Sequence[int]],
    candidates: Sequence[StereoCandidate],
    wanted: Array,
    tolerance_m: float,
) -> Iterator[list[int]]:
    """Depth-first search over candidates whose mutual distances agree with the drawing."""
    positions = np.array([candidate.position_m for candidate in candidates]).reshape(-1, 3)
    chosen = [-1] * len(order)

    def extend(depth: int) -> Iterator[list[int]]:
        if depth == len(order):
            yield list(chosen)
            return
        hole = order[depth]
        for candidate in choices[hole]:
            # A distance between two holes does not depend on how the part lies: most wrong
            # branches end here, before any pose is computed.
            if all(
                candidate != chosen[other]
                and abs(
                    float(np.linalg.norm(positions[candidate] - positions[chosen[other]]))
                    - wanted[hole, other]
                )
                < tolerance_m
                for other in order[:depth]
            ):
                chosen[hole] = candidate
                yield from extend(depth + 1)
                chosen[hole] = -1

    yield from extend(0)


def _checked(
    holes: Sequence[Hole], candidates: Sequence[StereoCandidate], tolerance_m: float
) -> Assignment | None:
    """The assignment; None when it does not fit or when the face would look away from the head.

    The layout of two holes, or of holes on a line, is given by their distances, which were compared
    before.
    """
    nominal = np.array([hole.position_m for hole in holes])
    measured = np.array([candidate.position_m for candidate in candidates])
    if on_a_line(nominal):
        return Assignment(tuple(candidates), 0.0)
    misfit_m = float(misfits_m(nominal, measured).max())
    if misfit_m > tolerance_m:
        return None
    # A layout that is its own mirror image fits in two ways. The face that is seen must look at the
    # head.
    outward = holes[0].outward
    if outward is not None and kabsch(nominal, measured)[0] @ outward @ measured.mean(axis=0) >= 0:
        return None
    return Assignment(tuple(candidates), misfit_m)
