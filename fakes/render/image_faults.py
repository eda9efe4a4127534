"""Faults in front of or inside the cameras, by name."""

from collections.abc import Callable
from dataclasses import replace
from typing import Final

import cv2
import numpy as np

from fakes.render.optics.canvas import Image
from fakes.world.scene import CameraScene, LensTruth, MonoTruth, ScenePlate, Seen, StereoTruth

Pictures = tuple[Image, ...]
"""Clean pictures, left and right or only one: grey levels before noise."""

SCENE_FAULTS: Final[dict[str, Callable[[CameraScene], CameraScene]]] = {
    "no_hole": lambda scene: replace(
        scene, bodies=tuple(_without_holes(body) for body in scene.bodies)
    ),
    "defocused": lambda scene: replace(scene, optics=_out_of_focus(scene.optics)),
}
"""Faults that change the scene before it is rendered."""

PICTURE_FAULTS: Final[dict[str, Callable[[Pictures], Pictures]]] = {
    "black": lambda pictures: tuple(0.01 * picture for picture in pictures),
    "saturated": lambda pictures: tuple(4.0 * picture + 150 for picture in pictures),
    "swapped": lambda pictures: pictures[::-1],
    "upside_down": lambda pictures: (*pictures[:-1], _turned(pictures[-1])),
    "occluded": lambda pictures: (_occluded(pictures[0]), *pictures[1:]),
}
"""Faults that spoil the picture of the true scene."""


def _without_holes(body: Seen) -> Seen:
    return replace(body, holes=()) if isinstance(body, ScenePlate) else body


def _out_of_focus(optics: StereoTruth | MonoTruth) -> StereoTruth | MonoTruth:
    if isinstance(optics, MonoTruth):
        return replace(optics, lens=_defocused(optics.lens))
    return replace(optics, left=_defocused(optics.left), right=_defocused(optics.right))


def _turned(picture: Image) -> Image:
    return np.ascontiguousarray(picture[::-1, ::-1])


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
    # Drawn at an eighth of the size and enlarged: out of focus it has no detail, and this is far
    # cheaper than a blur of the full picture.
    cover = np.asarray(cv2.resize(shade, (width, height)), dtype=np.float32)
    return np.asarray(picture * (1 - cover) + 25 * cover, dtype=np.float32)
