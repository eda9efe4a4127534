"""Measure the named holes of a part in one stereo pair."""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.errors.vision import (
    HoleAmbiguous,
    HoleMissing,
    ImageBlurred,
    ResidualsTooLarge,
    VisionError,
)
from cellctl.geometry.pose import MM, Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.diagnose import fault_without_layout
from cellctl.vision.features import Hole
from cellctl.vision.image_checks import check_pair
from cellctl.vision.layout import Assignment, Expectation, Spot, assignments
from cellctl.vision.measurement import HoleMeasurement, Method, PairMeasurement
from cellctl.vision.paper import measure_pair_by_paper
from cellctl.vision.plane_patch import X_AXIS
from cellctl.vision.registration import kabsch, on_a_line
from cellctl.vision.rim.pair import RimPair, measure_rims
from cellctl.vision.rim.sight import Located, Rejection, Sight, locate_rim
from cellctl.vision.search import NEAR, WIDE, ImagePair, spots_anywhere, spots_near
from cellctl.vision.stereo import epipolar_distances_px, midpoints, triangulate
from cellctl.vision.stereo_head import StereoHead

SEARCH_RADIUS_M = 12e-3
LAYOUT_TOLERANCE_M = 0.3e-3
"""Largest deviation of a measured hole from the drawing."""

_COARSE_TOLERANCE_M = 2.5e-3
_COARSE_REACH_PX = 7.0
_COARSE_EPIPOLAR_PX, _FINE_EPIPOLAR_PX = 2.5, 0.35
_SIZE_AGREEMENT = 0.02
_MAX_BLUR_PX = 2.5
_SAME_PLACE_M, _APART_M = 2.5e-3, 0.5e-3
"""Coarse places closer than the first lead to one fine place; fine ones farther apart differ."""
_MAX_TRIED = 10
_SIDES = ("left", "right")

_T = TypeVar("_T")


def measure_pair(
    left: Image,
    right: Image,
    head: StereoHead,
    holes: Sequence[Hole],
    *,
    camera_T_part: RigidTransform | None = None,
    method: Method = "default",
    search_radius_m: float = SEARCH_RADIUS_M,
    layout_tolerance_m: float = LAYOUT_TOLERANCE_M,
) -> PairMeasurement:
    """Measure every hole of ``holes``, or raise the ``VisionError`` that says why not.

    With ``camera_T_part`` (left camera) each hole is looked for within ``search_radius_m`` of its
    predicted place, without it in the whole image. Nothing is guessed: a hole that is missing, or
    that could be either of two features, is a fault.
    """
    check_pair(left, right, head)
    pair = ImagePair(head, left, right)
    expectation = None
    if camera_T_part is not None:
        expectation = Expectation(camera_T_part, search_radius_m)
    if method == "paper":
        return measure_pair_by_paper(pair, holes, expectation)
    good: list[PairMeasurement] = []
    faults: list[VisionError] = []
    for assignment in _find(pair, holes, expectation):
        if any(_same_place(assignment, other) for other in good):
            continue
        try:
            good.append(_measure(pair, holes, assignment, expectation, layout_tolerance_m))
        except VisionError as fault:
            faults.append(fault)
        if len(good) + len(faults) >= _MAX_TRIED:
            break
    if not good:
        raise faults[0]
    for other in good[1:]:
        _refuse_ambiguity(good[0], other)
    return good[0]


def _find(
    pair: ImagePair, holes: Sequence[Hole], expectation: Expectation | None
) -> list[Assignment]:
    """Assignments of features to holes, best first; a fault when there is none."""
    spots: list[Spot] = []
    for reach in (NEAR, WIDE):
        if expectation is None:
            spots = spots_anywhere(pair, holes, reach)
        else:
            spots = spots_near(pair, holes, expectation)
        found = assignments(holes, spots, tolerance_m=_COARSE_TOLERANCE_M, expectation=expectation)
        if found:
            return found
        if expectation is not None:
            break
    raise fault_without_layout(pair, holes, spots, expectation)


def _same_place(assignment: Assignment, measured: PairMeasurement) -> bool:
    """Whether an assignment is another coarse view of what is measured already."""
    return bool(np.abs(assignment.positions_m - measured.positions_m).max() < _SAME_PLACE_M)


def _measure(
    pair: ImagePair,
    holes: Sequence[Hole],
    assignment: Assignment,
    expectation: Expectation | None,
    tolerance_m: float,
) -> PairMeasurement:
    positions_m = assignment.positions_m
    normal = _plane_normal(holes, positions_m, expectation)
    located = _locate(pair, holes, positions_m, normal)
    positions_m = _positions(pair.head, holes, located)
    _check_layout(holes, positions_m, tolerance_m + 0.5e-3)
    normal = _plane_normal(holes, positions_m, expectation)
    measured: dict[str, HoleMeasurement] = {}
    blurs: list[tuple[float, float]] = []
    for index in sorted(range(len(holes)), key=lambda index: holes[index].kind == "thread"):
        hole, places = holes[index], located[index]
        sights = _sights(pair, positions_m[index], normal)
        known = np.median(blurs, axis=0) if blurs else None
        blur_px = None if known is None else (float(known[0]), float(known[1]))
        rims = _or_missing(hole, measure_rims(sights, hole, places, blur_px))
        if hole.kind != "thread":
            blurs.append((rims.left.blur_px, rims.right.blur_px))
        _check_sharpness(hole, rims)
        measured[hole.name] = _stereo(pair.head, hole, rims)
    result = PairMeasurement("default", tuple(measured[hole.name] for hole in holes))
    _check_layout(holes, result.positions_m, tolerance_m)
    return result


def _plane_normal(
    holes: Sequence[Hole], positions_m: Array, expectation: Expectation | None
) -> Array:
    """Normal of the holes' plane away from the head, from the best source there is."""
    nominal = np.array([hole.position_m for hole in holes])
    if not on_a_line(nominal):
        rotation, _ = kabsch(nominal, positions_m)
        return -rotation[:, 2]
    if expectation is not None:
        return np.asarray(-expectation.camera_T_part.rotation.as_matrix()[:, 2])
    middle = positions_m.mean(axis=0)
    return np.asarray(middle / np.linalg.norm(middle))


def _locate(
    pair: ImagePair, holes: Sequence[Hole], positions_m: Array, normal: Array
) -> list[tuple[Located, Located]]:
    """Both images of every rim, located by their edges."""
    found = []
    for hole, position_m in zip(holes, positions_m, strict=True):
        left, right = (
            _or_missing(hole, locate_rim(sight, hole, _COARSE_REACH_PX), side)
            for side, sight in zip(_SIDES, _sights(pair, position_m, normal), strict=True)
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
        if distance > _COARSE_EPIPOLAR_PX:
            raise HoleMissing(f"{hole.name}: left and right image disagree by {distance:.1f} px")
    return midpoints(head, left_px, right_px)


def _check_sharpness(hole: Hole, rims: RimPair) -> None:
    for side, rim in zip(_SIDES, (rims.left, rims.right), strict=True):
        if rim.blur_px > _MAX_BLUR_PX:
            raise ImageBlurred(
                f"{side}: the rim of {hole.name} is blurred over {rim.blur_px:.1f} px, "
                f"allowed {_MAX_BLUR_PX:.1f} px"
            )


def _stereo(head: StereoHead, hole: Hole, rims: RimPair) -> HoleMeasurement:
    """Both rims to a point, if they can be of the same hole."""
    left, right = rims.left, rims.right
    epipolar_px = float(
        epipolar_distances_px(head, left.point_px[None], right.point_px[None])[0, 0]
    )
    if epipolar_px > _FINE_EPIPOLAR_PX:
        raise HoleMissing(f"{hole.name}: left and right rim disagree by {epipolar_px:.2f} px")
    if abs(left.size_ratio - right.size_ratio) > _SIZE_AGREEMENT:
        raise HoleMissing(f"{hole.name}: left and right image show rims of different size")
    point = triangulate(head, left.point_px, right.point_px, rims.covariance_px2)
    return HoleMeasurement(
        name=hole.name,
        kind=hole.kind,
        left_px=left.point_px,
        right_px=right.point_px,
        left_covariance_px2=left.covariance_px2,
        right_covariance_px2=right.covariance_px2,
        position_m=point.position_m,
        covariance_m2=point.covariance_m2,
        left_ellipse=left.ellipse,
        right_ellipse=right.ellipse,
        diameter_m=hole.diameter_m * (left.size_ratio + right.size_ratio) / 2.0,
        epipolar_px=epipolar_px,
    )


def _sights(pair: ImagePair, position_m: Array, normal: Array) -> tuple[Sight, Sight]:
    """Where both cameras see a hole."""
    head, turn = pair.head, pair.head.rotation
    in_right = turn @ position_m + head.translation_m
    return (
        Sight(pair.left, head.left, position_m, normal, X_AXIS),
        Sight(pair.right, head.right, in_right, turn @ normal, turn @ X_AXIS),
    )


def _or_missing(hole: Hole, found: _T | Rejection, side: str = "") -> _T:
    """What was found, or ``HoleMissing`` with the reason."""
    if isinstance(found, Rejection):
        side = side or found.side
        raise HoleMissing(f"{hole.name}{side and f' ({side})'}: {found.reason}")
    return found


def _check_layout(holes: Sequence[Hole], positions_m: Array, tolerance_m: float) -> None:
    nominal = np.array([hole.position_m for hole in holes])
    if on_a_line(nominal):
        wanted = np.linalg.norm(nominal - nominal[0], axis=1)
        have = np.linalg.norm(positions_m - positions_m[0], axis=1)
        misfits = np.abs(have - wanted)
    else:
        rotation, translation_m = kabsch(nominal, positions_m)
        misfits = np.linalg.norm(positions_m - nominal @ rotation.T - translation_m, axis=1)
    worst = int(np.argmax(misfits))
    if misfits[worst] > tolerance_m:
        raise ResidualsTooLarge(
            f"{holes[worst].name} is {misfits[worst] / MM:.3f} mm off the drawing, "
            f"allowed {tolerance_m / MM:.3f} mm"
        )


def _refuse_ambiguity(first: PairMeasurement, other: PairMeasurement) -> None:
    for one, two in zip(first.holes, other.holes, strict=True):
        distance_m = float(np.linalg.norm(one.position_m - two.position_m))
        if distance_m > _APART_M:
            raise HoleAmbiguous(
                f"{one.name} could be either of two features {distance_m / MM:.1f} mm apart"
            )
