"""Measure the named holes of a part in one stereo pair."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.errors.vision import (
    HoleMissing,
    ImageBlurred,
    VisionError,
)
from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.image_checks import check_pair
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.camera.triangulation import epipolar_distances_px, triangulate
from cellctl.vision.features.hole import Hole
from cellctl.vision.features.known_kinds import kind_of
from cellctl.vision.holes.arrangements import arrangements
from cellctl.vision.holes.correspondence import (
    Assignment,
    Expectation,
)
from cellctl.vision.holes.drawing_fit import check_layout, only_one
from cellctl.vision.holes.locate import LOCATE_REACH_PX, locate_holes, rim_rois
from cellctl.vision.holes.search import HeadImages
from cellctl.vision.measurement import HoleMeasurement, Method, PairMeasurement
from cellctl.vision.paper_baseline import measure_pair_by_paper
from cellctl.vision.rim.image_scale import with_image_scales
from cellctl.vision.rim.roi import RimRoi
from cellctl.vision.rim.stereo_fit import RimPair, measure_rims, refuse_too_uncertain

SEARCH_RADIUS_M = 12e-3
"""Distance from its predicted place within which a hole is looked for."""
LAYOUT_TOLERANCE_M = 0.3e-3
"""Largest deviation of a measured hole from the drawing: what is off by more is another feature, or
another part."""

_COARSE_M = 0.5e-3
"""Additional deviation of holes that are located by their edges alone."""
_EPIPOLAR_PX = 0.35
"""Largest distance of a measured centre from its epipolar line: measured centres are known to a
tenth of it, so more means two different features or a worn calibration."""
_SIZE_AGREEMENT = 0.02
"""Largest difference of the diameters in both images, relative."""
_MAX_BLUR_PX = 2.5
"""Blur of a rim (standard deviation) beyond which its image counts as out of focus."""
_SAME_PLACE_PX = 1.0
"""Coarse places nearer to each other than this, in every hole, are the same assignment."""
_MAX_TRIED = 10
"""Most assignments that are measured, each with all its rims."""


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
    images = HeadImages(head, left, right)
    expectation = None
    if camera_T_part is not None:
        expectation = Expectation(camera_T_part, search_radius_m)
    if method == "paper":
        return measure_pair_by_paper(images, holes, expectation)
    good: list[PairMeasurement] = []
    faults: list[VisionError] = []
    tried: list[Array] = []
    for assignment in arrangements(images, holes, expectation):
        if _done_already(assignment.places_px, good, tried):
            continue
        tried.append(assignment.places_px)
        try:
            good.append(_measure(images, holes, assignment, expectation, layout_tolerance_m))
        except VisionError as fault:
            faults.append(fault)
        if len(tried) >= _MAX_TRIED:
            break
    if not good:
        raise faults[0]
    return only_one(holes, good)


def _done_already(
    places_px: Array, good: Sequence[PairMeasurement], tried: Sequence[Array]
) -> bool:
    """Whether these places lead to holes that are measured already, or have been tried."""
    measured = [
        np.array([[hole.left_px, hole.right_px] for hole in result.holes]) for result in good
    ]
    return any(np.abs(places_px - other).max() < LOCATE_REACH_PX for other in measured) or any(
        np.abs(places_px - other).max() < _SAME_PLACE_PX for other in tried
    )


def _measure(
    images: HeadImages,
    holes: Sequence[Hole],
    assignment: Assignment,
    expectation: Expectation | None,
    tolerance_m: float,
) -> PairMeasurement:
    located = locate_holes(images, holes, assignment.positions_m, expectation)
    # A wrong arrangement ends here, before the expensive fits. Edges alone are less exact, hence
    # the allowance.
    check_layout(holes, located.positions_m, tolerance_m + _COARSE_M)
    measured: dict[int, RimPair] = {}
    all_rois = [
        rim_rois(images, hole, place_m, located.normal)
        for hole, place_m in zip(holes, located.positions_m, strict=True)
    ]
    blurs: list[tuple[float, float]] = []
    # Rims that show the blur of the images come first. The others are given it: the turns of a
    # thread, for one, look like blur themselves.
    for index in sorted(range(len(holes)), key=lambda index: not kind_of(holes[index]).lends_blur):
        hole = holes[index]
        rois = all_rois[index]
        known = np.median(blurs, axis=0) if blurs else None
        blur_px = None if known is None else (float(known[0]), float(known[1]))
        rims = measure_rims(rois, located.places[index], blur_px)
        if kind_of(hole).lends_blur:
            blurs.append((rims.left.blur_px, rims.right.blur_px))
        _check_sharpness(rois, rims)
        measured[index] = rims
    pairs = with_image_scales([measured[index] for index in range(len(holes))])
    for rois, rims in zip(all_rois, pairs, strict=True):
        refuse_too_uncertain(rois, rims)
    result = PairMeasurement(
        "default",
        tuple(_stereo(images.head, hole, rims) for hole, rims in zip(holes, pairs, strict=True)),
    )
    check_layout(holes, result.positions_m, tolerance_m)
    return result


def _check_sharpness(rois: tuple[RimRoi, RimRoi], rims: RimPair) -> None:
    for roi, rim in zip(rois, (rims.left, rims.right), strict=True):
        if rim.blur_px > _MAX_BLUR_PX:
            raise ImageBlurred(
                f"{roi.side}: the rim of {roi.hole.name} is blurred over {rim.blur_px:.1f} px, "
                f"allowed {_MAX_BLUR_PX:.1f} px"
            )


def _stereo(head: StereoHead, hole: Hole, rims: RimPair) -> HoleMeasurement:
    """Both rims to a point, if they can be of the same hole."""
    left, right = rims.left, rims.right
    epipolar_px = float(
        epipolar_distances_px(head, left.point_px[None], right.point_px[None])[0, 0]
    )
    # Depth is computed along the epipolar line, so it cannot show an error across it, which is what
    # two different holes or a worn calibration leave.
    if epipolar_px > _EPIPOLAR_PX:
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
