"""Scratches, stains and punch marks: fixed to the part, and easily taken for holes."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Final, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from fakes.render.optics.canvas import Image, Patch
from fakes.render.optics.coverage import coverage
from fakes.render.optics.lattice import window_around
from fakes.render.optics.lens import Array, View
from fakes.render.optics.surface import surface_map, to_pixels
from fakes.render.options import RenderOptions
from fakes.world.scene import SceneHole, ScenePlate

MarkKind = Literal["stain", "punch", "spot"]

_SHIFT: Final = 5
_CLEARANCE_M: Final = 1.5e-3
"""Least distance of a false circle from a hole's outer rim."""
_KINDS: Final[tuple[tuple[MarkKind, float, tuple[float, float], tuple[float, float]], ...]] = (
    ("stain", 0.45, (2e-3, 7e-3), (-0.14, -0.04)),
    ("punch", 0.35, (0.6e-3, 1.6e-3), (0.25, 0.5)),
    ("spot", 0.20, (2.2e-3, 3.3e-3), (-0.5, -0.25)),
)
"""Share of all false circles, radius, relative change of the grey."""


@dataclass(frozen=True, slots=True)
class Mark:
    """A false circle in the face of a part."""

    kind: MarkKind
    position_m: tuple[float, float]
    radius_m: float
    strength: float
    """Relative change of the grey."""


@dataclass(frozen=True, slots=True, eq=False)
class Scratch:
    """A line of points in the face, shape (n, 2), and its relative change of the grey."""

    points_m: Array
    strength: float


@lru_cache(maxsize=8)
def marks_of(
    seed: int, size_m: tuple[float, float], holes: tuple[SceneHole, ...], per_m2: float
) -> tuple[Mark, ...]:
    """False circles of a part, clear of its holes."""
    # A generator for each kind of clutter, from the seed of the part: more scratches do not move
    # the stains, and every exposure of a part shows the same ones.
    rng = np.random.default_rng([seed, 21])
    places: list[Mark] = []
    for kind, share, radii_m, strengths in _KINDS:
        for _ in range(round(size_m[0] * size_m[1] * per_m2 * share)):
            radius_m, strength = float(rng.uniform(*radii_m)), float(rng.uniform(*strengths))
            place = rng.uniform(-0.5, 0.5, 2) * size_m
            # A stain over a rim would spoil the truth of that hole. Scratches may cross rims,
            # because real ones do.
            if _is_clear(place, radius_m, holes):
                x, y = (float(value) for value in place)
                places.append(Mark(kind, (x, y), radius_m, strength))
    return tuple(places)


@lru_cache(maxsize=8)
def scratches_of(seed: int, size_m: tuple[float, float], per_m2: float) -> tuple[Scratch, ...]:
    """Scratches of a part: nearly straight, anywhere, over rims too."""
    rng = np.random.default_rng([seed, 22])
    lines = []
    for _ in range(round(size_m[0] * size_m[1] * per_m2)):
        along = np.linspace(-0.5, 0.5, 9) * rng.gamma(2.0, 9e-3)
        bend = rng.normal(0, 2.0) * along**2
        angle = rng.vonmises(0, 0.7) if rng.random() < 0.6 else rng.uniform(0, np.pi)
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        middle = rng.uniform(-0.5, 0.5, 2) * size_m
        points = np.column_stack([along, bend]) @ turn.T + middle
        lines.append(Scratch(points, float(rng.choice([-0.22, -0.12, 0.12, 0.2]))))
    return tuple(lines)


def draw_clutter(
    view: View, image: Image, plate: ScenePlate, options: RenderOptions, light_azimuth: float
) -> None:
    """Draw the scratches, stains and marks of ``plate`` into ``image``."""
    _draw_scratches(view, image, plate, options)
    for mark in marks_of(plate.seed, plate.size_m, plate.holes, options.false_circles_per_m2):
        factor = _mark_patch(view, plate, mark, light_azimuth)
        if factor is not None:
            factor.lay_over(image)


def _draw_scratches(view: View, image: Image, plate: ScenePlate, options: RenderOptions) -> None:
    pose = plate.camera_T_part
    lines: dict[float, list[NDArray[np.int32]]] = {}
    limits = np.array(view.size_px)
    for scratch in scratches_of(plate.seed, plate.size_m, options.scratches_per_m2):
        points = np.column_stack([scratch.points_m, np.zeros(len(scratch.points_m))])
        in_view = (view.view_T_head * pose).apply(points)
        # The polynomial of the lens folds back far outside of the image, and would draw such points
        # into it.
        if np.abs(in_view[:, :2] / in_view[:, 2:]).max() > 0.5:
            continue
        pixels = to_pixels(view, pose, points)
        if (pixels.max(axis=0) > 0).all() and (pixels.min(axis=0) < limits).all():
            fixed = np.rint(pixels * 2**_SHIFT).astype(np.int32)
            # Collected by strength, because one mask of the size of the image for each scratch
            # would cost more than all the rest of the picture.
            lines.setdefault(scratch.strength, []).append(fixed)
    for strength, polylines in lines.items():
        mask = np.zeros(image.shape, np.uint8)
        cv2.polylines(mask, polylines, False, 255, 1, cv2.LINE_AA, _SHIFT)  # noqa: FBT003
        image += image * (mask * np.float32(strength / 255))


def _mark_patch(view: View, plate: ScenePlate, mark: Mark, light_azimuth: float) -> Patch | None:
    pose = plate.camera_T_part
    angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    rim = 1.3 * mark.radius_m * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(24)])
    points = rim + np.array([*mark.position_m, 0.0])
    in_view = (view.view_T_head * pose).apply(points)
    if np.abs(in_view[:, :2] / in_view[:, 2:]).max() > 0.5:
        return None
    window = window_around(view, to_pixels(view, pose, points), 3, 2)
    if window is None:
        return None
    x, y = surface_map(view, pose, window)
    x, y = (x - mark.position_m[0]) / mark.radius_m, (y - mark.position_m[1]) / mark.radius_m
    change = window.mean(_mark_shape(mark, x, y, light_azimuth))
    return Patch(window, 1 + mark.strength * change, np.zeros_like(change))


def _mark_shape(mark: Mark, x: Array, y: Array, light_azimuth: float) -> Array:
    radius = np.hypot(x, y)
    if mark.kind == "stain":  # a dried drop: soft inside, darker border
        body = 1 / (1 + np.exp((radius - 1) / 0.05))
        return np.asarray(body * (0.45 + 0.8 * np.exp(-(((radius - 0.93) / 0.07) ** 2))))
    inside = 1 - coverage(radius - 1)
    if mark.kind == "spot":  # a blot of ink with a fairly sharp border
        return np.asarray(inside * (0.9 + 0.1 * np.cos(3 * np.arctan2(y, x))))
    slope = x * np.cos(light_azimuth) - y * np.sin(light_azimuth)
    return np.asarray(-inside * slope * radius * 1.5)


def _is_clear(place: Array, radius_m: float, holes: tuple[SceneHole, ...]) -> bool:
    for hole in holes:
        outer_m = max(hole.diameter_m * 1.15, hole.countersink_m or 0.0) / 2
        distance = float(np.hypot(*(place - np.array(hole.position_m))))
        if distance < outer_m + 1.3 * radius_m + _CLEARANCE_M:
            return False
    return True
