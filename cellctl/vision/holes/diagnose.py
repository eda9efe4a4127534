"""Why no arrangement of features fits: holes missing, images exchanged, or a camera turned."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cellctl.errors.vision import CamerasSwapped, CameraUpsideDown, HoleMissing, VisionError
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.features.hole import Hole
from cellctl.vision.holes.correspondence import (
    Expectation,
    StereoCandidate,
    assignments,
    holes_without_spot,
)
from cellctl.vision.holes.search import NEAR, WIDE, HeadImages, spots_anywhere

_TOLERANCE_M = 1.5e-3


def fault_without_layout(
    pair: HeadImages,
    holes: Sequence[Hole],
    spots: Sequence[StereoCandidate],
    expectation: Expectation | None,
) -> VisionError:
    """The fault to raise when no assignment of ``spots`` fits the drawing."""
    for reach in (NEAR, WIDE) if len(holes) >= 3 else ():
        if (fault := _wrong_images(pair, holes, reach)) is not None:
            return fault
    missing = holes_without_spot(holes, spots, expectation)
    if missing:
        return HoleMissing(f"nothing like {', '.join(missing)} was seen by both cameras")
    partial = _largest_part(holes, spots, expectation)
    absent = [hole.name for hole in holes if hole.name not in partial]
    if len(partial) >= 3:
        return HoleMissing(f"{', '.join(absent)} not where the other holes say")
    names = ", ".join(hole.name for hole in holes)
    return HoleMissing(f"no arrangement of the features seen fits the drawing of {names}")


def _wrong_images(
    pair: HeadImages, holes: Sequence[Hole], reach: tuple[float, float]
) -> VisionError | None:
    """The fault when the holes are found once the images are exchanged or turned."""
    if _fits(replace(pair, left=pair.right, right=pair.left), holes, reach):
        return CamerasSwapped("the holes are found with the images exchanged")
    left, right = _turned(pair.left), _turned(pair.right)
    turned = {
        "the left image": replace(pair, left=left),
        "the right image": replace(pair, right=right),
        "both images": replace(pair, left=left, right=right),
    }
    for which, other in turned.items():
        if _fits(other, holes, reach):
            return CameraUpsideDown(f"the holes are found with {which} turned by 180°")
    return None


def _fits(pair: HeadImages, holes: Sequence[Hole], reach: tuple[float, float]) -> bool:
    spots = spots_anywhere(pair, holes, reach)
    return bool(assignments(holes, spots, tolerance_m=_TOLERANCE_M, expectation=None))


def _turned(image: Image) -> Image:
    return np.ascontiguousarray(image[::-1, ::-1])


def _largest_part(
    holes: Sequence[Hole], spots: Sequence[StereoCandidate], expectation: Expectation | None
) -> set[str]:
    """Names of the holes that fit when one hole is left out."""
    for left_out in holes if len(holes) > 3 else ():
        rest = [hole for hole in holes if hole is not left_out]
        if assignments(rest, spots, tolerance_m=_TOLERANCE_M, expectation=expectation):
            return {hole.name for hole in rest}
    return set()
