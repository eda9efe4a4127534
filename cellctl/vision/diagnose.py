"""Why no arrangement of features fits: holes missing, images exchanged, or a camera turned."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.errors.vision import CamerasSwapped, CameraUpsideDown, HoleMissing, VisionError
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.features import Hole
from cellctl.vision.layout import Spot, assignments, holes_without_spot
from cellctl.vision.search import NEAR, spots_anywhere
from cellctl.vision.stereo_head import StereoHead

_TOLERANCE_M = 1.5e-3


def fault_without_layout(
    head: StereoHead,
    left: Image,
    right: Image,
    holes: Sequence[Hole],
    spots: Sequence[Spot],
    camera_T_part: RigidTransform | None,
    search_radius_m: float,
) -> VisionError:
    """The fault to raise when no assignment of ``spots`` fits the drawing."""
    if len(holes) >= 3:
        if _fits(head, right, left, holes):
            return CamerasSwapped("the holes are found with the images exchanged")
        for side, pair in (("left", (_turned(left), right)), ("right", (left, _turned(right)))):
            if _fits(head, *pair, holes):
                return CameraUpsideDown(f"the holes are found with the {side} image turned by 180°")
    missing = holes_without_spot(holes, spots, camera_T_part, search_radius_m)
    if missing:
        return HoleMissing(f"nothing like {', '.join(missing)} was seen by both cameras")
    partial = _largest_part(holes, spots, camera_T_part, search_radius_m)
    absent = [hole.name for hole in holes if hole.name not in partial]
    if len(partial) >= 3:
        return HoleMissing(f"{', '.join(absent)} not where the other holes say")
    names = ", ".join(hole.name for hole in holes)
    return HoleMissing(f"no arrangement of the features seen fits the drawing of {names}")


def _fits(head: StereoHead, left: Image, right: Image, holes: Sequence[Hole]) -> bool:
    spots = spots_anywhere(head, left, right, holes, NEAR)
    found = assignments(
        holes, spots, tolerance_m=_TOLERANCE_M, camera_T_part=None, search_radius_m=0.0
    )
    return bool(found)


def _turned(image: Image) -> Image:
    return np.ascontiguousarray(image[::-1, ::-1])


def _largest_part(
    holes: Sequence[Hole],
    spots: Sequence[Spot],
    camera_T_part: RigidTransform | None,
    search_radius_m: float,
) -> set[str]:
    """Names of the holes that fit when one hole is left out."""
    for left_out in holes if len(holes) > 3 else ():
        rest = [hole for hole in holes if hole is not left_out]
        if assignments(
            rest,
            spots,
            tolerance_m=_TOLERANCE_M,
            camera_T_part=camera_T_part,
            search_radius_m=search_radius_m,
        ):
            return {hole.name for hole in rest}
    return set()
