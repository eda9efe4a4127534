"""Why no assignment of features fits: holes missing, images exchanged, or a camera turned.

Exchanged or turned images are recognised by trying: with the mistake undone the features that were
found fit the drawing.
"""

from collections.abc import Sequence

from cellctl.errors.vision import CamerasSwapped, CameraUpsideDown, HoleMissing, VisionError
from cellctl.vision.features.hole import Hole
from cellctl.vision.holes.correspondence import (
    Expectation,
    StereoCandidate,
    assignments,
    holes_without_candidate,
)
from cellctl.vision.holes.search import NEAR, WIDE, RoundFeatures, WholeImageSearch

_TOLERANCE_M = 1.5e-3
"""Tighter than the first search (``measure``): here a chance fit would accuse a camera."""


def fault_without_layout(
    search: WholeImageSearch,
    candidates: Sequence[StereoCandidate],
    expectation: Expectation | None,
) -> VisionError:
    """The fault to raise when no assignment of ``candidates`` fits the drawing."""
    holes = search.holes
    # One or two holes fit nearly any image by chance; only from three on does a fit prove that the
    # images are exchanged or turned.
    for reach in (NEAR, WIDE) if len(holes) >= 3 else ():
        if (fault := _wrong_images(search.features(reach), holes)) is not None:
            return fault
    missing = holes_without_candidate(holes, candidates, expectation)
    if missing:
        return HoleMissing(f"nothing like {', '.join(missing)} was seen by both cameras")
    partial = _largest_part(holes, candidates, expectation)
    absent = [hole.name for hole in holes if hole.name not in partial]
    if len(partial) >= 3:
        return HoleMissing(f"{', '.join(absent)} not where the other holes say")
    names = ", ".join(hole.name for hole in holes)
    return HoleMissing(f"no arrangement of the features seen fits the drawing of {names}")


def _wrong_images(seen: RoundFeatures, holes: Sequence[Hole]) -> VisionError | None:
    """The fault when the holes are found once the images are exchanged or turned."""
    if _fits(seen.exchanged(), holes):
        return CamerasSwapped("the holes are found with the images exchanged")
    turned = {
        "the left image": seen.turned(left=True, right=False),
        "the right image": seen.turned(left=False, right=True),
        "both images": seen.turned(left=True, right=True),
    }
    for which, other in turned.items():
        if _fits(other, holes):
            return CameraUpsideDown(f"the holes are found with {which} turned by 180°")
    return None


def _fits(seen: RoundFeatures, holes: Sequence[Hole]) -> bool:
    return bool(assignments(holes, seen.pairs(), tolerance_m=_TOLERANCE_M, expectation=None))


def _largest_part(
    holes: Sequence[Hole], candidates: Sequence[StereoCandidate], expectation: Expectation | None
) -> set[str]:
    """Names of the holes that fit when one hole is left out."""
    for left_out in holes if len(holes) > 3 else ():
        rest = [hole for hole in holes if hole is not left_out]
        if assignments(rest, candidates, tolerance_m=_TOLERANCE_M, expectation=expectation):
            return {hole.name for hole in rest}
    return set()
