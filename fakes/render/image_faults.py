"""Things that go wrong in front of or inside the cameras, by name."""

from collections.abc import Callable
from dataclasses import replace
from typing import Final

import cv2
import numpy as np

from fakes.render.canvas import Image
from fakes.world.scene import CameraScene, LensTruth, ScenePlate

Pair = tuple[Image, Image]
"""Clean pictures, left and right: grey levels before noise."""

SCENE_FAULTS: Final[dict[str, Callable[[CameraScene], CameraScene]]] = {
    "no_hole": lambda scene: replace(
        scene, frame=_without_holes(scene.frame), deck=_without_holes(scene.deck)
    ),
    "defocused": lambda scene: replace(
        scene,
        stereo=replace(
            scene.stereo, left=_defocused(scene.stereo.left), right=_defocused(scene.stereo.right)
        ),
    ),
}
"""What is rendered is another scene."""

PICTURE_FAULTS: Final[dict[str, Callable[[Pair], Pair]]] = {
    "black": lambda pair: (0.01 * pair[0], 0.01 * pair[1]),
    "saturated": lambda pair: (4.0 * pair[0] + 150, 4.0 * pair[1] + 150),
    "swapped": lambda pair: (pair[1], pair[0]),
    "upside_down": lambda pair: (pair[0], np.ascontiguousarray(pair[1][::-1, ::-1])),
    "occluded": lambda pair: (_occluded(pair[0]), pair[1]),
}
"""The picture of the true scene is spoilt."""


def _without_holes(plate: ScenePlate | None) -> ScenePlate | None:
    return None if plate is None else replace(plate, holes=())


def _defocused(lens: LensTruth) -> LensTruth:
    return replace(lens, blur_px=7.0)


def _occluded(picture: Image) -> Image:
    """A hose hangs in front of the lens, out of focus, over the middle of the picture."""
    height, width = picture.shape
    shade = np.zeros((height // 8, width // 8), np.float32)
    points = np.array([[0.0, 0.1], [0.35, 0.35], [0.5, 0.6], [0.7, 0.8], [1.0, 0.95]])
    pixels = np.rint(points * [width // 8, height // 8]).astype(np.int32)
    cv2.polylines(shade, [pixels], False, 1.0, height // 14)  # noqa: FBT003
    shade = cv2.GaussianBlur(shade, (0, 0), 3.0)
    cover = np.asarray(cv2.resize(shade, (width, height)), dtype=np.float32)
    return np.asarray(picture * (1 - cover) + 25 * cover, dtype=np.float32)
