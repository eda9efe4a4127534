"""Pictures of a measurement that failed: where each hole was expected, and which were measured."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array
from cellctl.processes.deck_to_frame.poses.part_measurer import HeadGeometry
from cellctl.vision.camera.lens import project
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.features.feature_file import FeatureFile
from cellctl.vision.features.hole import Hole
from cellctl.vision.measurement import PairMeasurement, Side
from cellctl.vision.picture import annotate

_JPEG_QUALITY = 85
_POINTS = 60
_NEAREST_M = 0.05
"""No lens focuses nearer; what lies behind the camera has no place in its picture."""
_FARTHEST_PX = 1e5
"""A place farther outside the picture than this comes from a distortion that was extrapolated."""
_CAPTION_PX = 48
_EXPECTED, _WHITE = (255, 0, 255), (255, 255, 255)


@dataclass(frozen=True, slots=True, eq=False)
class ExpectedRim:
    """Where the rim of a hole should be in an image, by the prediction of the part's pose."""

    name: str
    outline_px: Array
    """Shape (n, 2)."""


Expected = Mapping[tuple[int, Side], tuple[ExpectedRim, ...]]
"""Expected rims by head, from 1 on, and camera."""


def expected_rims(
    features: FeatureFile, c1_T_part: RigidTransform, geometry: HeadGeometry
) -> Expected:
    """The rims that each camera should see."""
    at_1, at_2 = geometry.camera_T_part(c1_T_part)
    heads: tuple[tuple[Literal[1, 2], StereoHead, RigidTransform], ...] = (
        (1, geometry.head_1, at_1),
        (2, geometry.head_2, at_2),
    )
    found: dict[tuple[int, Side], tuple[ExpectedRim, ...]] = {}
    for number, model, left_T_part in heads:
        places: tuple[tuple[Side, RigidTransform], ...] = (
            ("left", left_T_part),
            ("right", model.right_T_left * left_T_part),
        )
        for side, camera_T_part in places:
            camera = model.left if side == "left" else model.right
            rims = []
            for hole in features.seen_by(number):
                points = camera_T_part.apply(_rim_m(hole))
                if points[:, 2].min() > _NEAREST_M:
                    outline_px = project(camera, points)
                    if np.abs(outline_px).max() < _FARTHEST_PX:
                        rims.append(ExpectedRim(hole.name, outline_px))
            found[number, side] = tuple(rims)
    return found


def _rim_m(hole: Hole) -> Array:
    """Points on the rim in the frame of the part, shape (n, 3)."""
    normal = np.array([0.0, 0.0, 1.0]) if hole.outward is None else hole.outward
    # Any direction across the normal: the axis of the part that is nearest to being square to it.
    across = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    across /= np.linalg.norm(across)
    turn = np.linspace(0.0, 2.0 * np.pi, _POINTS, endpoint=False)[:, None]
    circle = np.cos(turn) * across + np.sin(turn) * np.cross(normal, across)
    return np.asarray(hole.position_m + hole.diameter_m / 2.0 * circle)


def draw_failed(
    image: NDArray[np.uint8],
    expected: Sequence[ExpectedRim],
    found: PairMeasurement | None,
    side: Side,
    fault: int,
) -> bytes:
    """The image as JPEG with a caption below it; runs in a vision worker.

    Expected rims are dotted, so that what is measured stays visible under them.
    """
    import cv2

    if found is None:
        picture = np.asarray(cv2.cvtColor(image, cv2.COLOR_GRAY2BGR), dtype=np.uint8)
        said = f"F{fault}. Dotted: where each hole was expected; none was measured here"
    else:
        picture = annotate(image, found, side)
        said = f"F{fault}. Dotted: where each hole was expected; green: measured"
    font = cv2.FONT_HERSHEY_SIMPLEX
    for rim in expected:
        for x, y in np.rint(rim.outline_px).astype(int):
            cv2.circle(picture, (int(x), int(y)), 1, _EXPECTED, -1)
        corner = rim.outline_px.max(axis=0) + 6.0
        place = (int(corner[0]), int(corner[1]))
        cv2.putText(picture, rim.name, place, font, 1.1, _EXPECTED, 2, cv2.LINE_AA)
    caption = np.zeros((_CAPTION_PX, picture.shape[1], 3), np.uint8)
    cv2.putText(caption, said, (8, _CAPTION_PX - 16), font, 0.9, _WHITE, 2, cv2.LINE_AA)
    return as_jpeg(np.vstack([picture, caption]))


def as_jpeg(picture: NDArray[np.uint8]) -> bytes:
    """A picture, shape (h, w, 3) in OpenCV's order of colours, as the report shows it."""
    import cv2

    _, data = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY])
    return bytes(data)
