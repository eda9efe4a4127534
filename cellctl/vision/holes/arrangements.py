"""Which of the round features in a pair of images are the holes of a drawing."""

from collections.abc import Sequence

from cellctl.vision.features.hole import Hole
from cellctl.vision.holes.correspondence import (
    Assignment,
    Expectation,
    StereoCandidate,
    assignments,
)
from cellctl.vision.holes.diagnose import fault_without_layout
from cellctl.vision.holes.search import NEAR, WIDE, HeadImages, WholeImageSearch, search_windows

_TOLERANCE_M = 2.5e-3
"""Largest deviation of features as they are first found, to one or two pixels."""


def arrangements(
    images: HeadImages, holes: Sequence[Hole], expectation: Expectation | None
) -> list[Assignment]:
    """Assignments of features to holes, best first, near where the part is expected or else
    anywhere in both images.

    Raises ``HoleMissing``, ``CamerasSwapped`` or ``CameraUpsideDown`` when there is none.
    """
    search = WholeImageSearch(images, holes)
    candidates: list[StereoCandidate] = []
    # The narrow range first: it costs less, and fewer chance features compete for the drawing.
    for reach in (NEAR, WIDE):
        if expectation is None:
            candidates = search.features(reach).pairs()
        else:
            candidates = search_windows(images, holes, expectation)
        found = assignments(holes, candidates, tolerance_m=_TOLERANCE_M, expectation=expectation)
        if found:
            return found
        # Windows do not depend on the range of distance, so a second search would find the same.
        if expectation is not None:
            break
    raise fault_without_layout(search, candidates, expectation)
