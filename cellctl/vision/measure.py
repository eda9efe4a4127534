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
from cellctl.vision.rim.roi import LocatedRim, RimRoi
from cellctl.vision.rim.shown_spread import image_spread, shown_spread
from cellctl.vision.rim.spread import ImageSpread
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
_SPREAD_ROUNDS = 3
"""Rounds in which the spread of the images is improved. Each finds, to first order, what the fits
of the round before have not modelled; one is mostly enough."""
_LEAST_GAIN = 30.0
"""Fall of the information criterion (BIC), summed over all rims, that a spread must bring. Chance
brings less."""
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
    all_rois = [
        rim_rois(images, hole, place_m, located.normal)
        for hole, place_m in zip(holes, located.positions_m, strict=True)
    ]
    measured = _all_rims(all_rois, located.places)
    pairs = with_image_scales(measured)
    for rois, rims in zip(all_rois, pairs, strict=True):
        refuse_too_uncertain(rois, rims)
    result = PairMeasurement(
        "default",
        tuple(_stereo(images.head, hole, rims) for hole, rims in zip(holes, pairs, strict=True)),
    )
    check_layout(holes, result.positions_m, tolerance_m)
    return result


def _all_rims(
    rois: Sequence[tuple[RimRoi, RimRoi]], places: Sequence[tuple[LocatedRim, LocatedRim]]
) -> list[RimPair]:
    """All rims of a pair, with the spreads of its images that they show together."""
    spreads = (ImageSpread(), ImageSpread())
    rims = _rims_with_spreads(rois, places, spreads)
    for _ in range(_SPREAD_ROUNDS):
        likely = _likely_spreads(spreads, rois, rims)
        # ``image_spread`` gives the very same object back where it has found nothing new.
        if likely[0] is spreads[0] and likely[1] is spreads[1]:
            break
        trial = _rims_with_spreads(rois, places, likely)
        if not _explained_better(trial, rims):
            break
        spreads, rims = likely, trial
    return rims


def _likely_spreads(
    before: tuple[ImageSpread, ImageSpread],
    rois: Sequence[tuple[RimRoi, RimRoi]],
    rims: Sequence[RimPair],
) -> tuple[ImageSpread, ImageSpread]:
    """The spreads of both images that the rims show, left and right.

    Only kinds of holes count whose blur is that of the image: a thread looks blurred by itself.
    """
    telling = [pair for pair, (roi, _) in zip(rims, rois, strict=True) if roi.kind.lends_blur]
    left, right = (
        image_spread(before[image], [shown_spread(pair.singles[image]) for pair in telling])
        for image in (0, 1)
    )
    return left, right


def _explained_better(trial: Sequence[RimPair], rims: Sequence[RimPair]) -> bool:
    """Whether most rims fit better with the spreads of the trial, and by more than chance.

    Only rims with one edge in the trial count. Light on a wall or a broken edge of one rim may look
    like a spread, but a spread belongs to the image and must explain the other rims better, too.
    """
    gains = np.array(
        [
            sum(fit.bic() for fit in before.singles) - sum(fit.bic() for fit in after.singles)
            for before, after in zip(rims, trial, strict=True)
            if after.one_edge
        ]
    )
    return bool(gains.size and np.median(gains) > 0.0 and gains.sum() > _LEAST_GAIN)


def _rims_with_spreads(
    all_rois: Sequence[tuple[RimRoi, RimRoi]],
    places: Sequence[tuple[LocatedRim, LocatedRim]],
    spreads: tuple[ImageSpread, ImageSpread],
) -> list[RimPair]:
    measured: dict[int, RimPair] = {}
    blurs: list[tuple[float, float]] = []
    # Rims that show the blur of the images come first. The others are given it: the turns of a
    # thread, for one, look like blur themselves.
    for index in sorted(
        range(len(places)), key=lambda index: not all_rois[index][0].kind.lends_blur
    ):
        rois = all_rois[index]
        known = np.median(blurs, axis=0) if blurs else None
        blur_px = None if known is None else (float(known[0]), float(known[1]))
        rims = measure_rims(rois, places[index], blur_px, spreads)
        if rois[0].kind.lends_blur:
            blurs.append((rims.left.blur_px, rims.right.blur_px))
        _check_sharpness(rois, rims, spreads)
        measured[index] = rims
    return [measured[index] for index in range(len(places))]


def _check_sharpness(
    rois: tuple[RimRoi, RimRoi], rims: RimPair, spreads: tuple[ImageSpread, ImageSpread]
) -> None:
    for roi, rim, spread in zip(rois, (rims.left, rims.right), spreads, strict=True):
        blur_px = float(np.hypot(rim.blur_px, np.linalg.norm(spread.movement_px)))
        if blur_px > _MAX_BLUR_PX:
            raise ImageBlurred(
                f"{roi.side}: the rim of {roi.hole.name} is blurred over {blur_px:.1f} px, "
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
        left_out=max(left.left_out, right.left_out),
    )
