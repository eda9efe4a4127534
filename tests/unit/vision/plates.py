"""Small analytic test images: a plate with holes, ray by ray, independent of the fake cell."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import MM, Array, pose_from_xyzabc
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.lens import project, undistort
from cellctl.vision.camera.stereo_head import CameraModel, StereoHead, stereo_head_to_json
from cellctl.vision.features.hole import Hole

SUB = 8


def table_1_head() -> StereoHead:
    """A head of the size of the paper's table 1: f 3580 px, baseline 179 mm, toe-in 20°."""
    left = CameraModel(
        np.array([[3580.0, 0.0, 1224.0], [0.0, 3581.0, 995.0], [0.0, 0.0, 1.0]]),
        np.array([-0.07, 0.17, 4e-4, -3e-4, 0.0]),
    )
    right = CameraModel(
        np.array([[3576.0, 0.0, 1230.0], [0.0, 3577.0, 1001.0], [0.0, 0.0, 1.0]]),
        np.array([-0.068, 0.15, -2e-4, 4e-4, 0.0]),
    )
    left_T_right = RigidTransform.from_components(
        [0.179 * np.cos(np.radians(10)), 0.0, 0.179 * np.sin(np.radians(10))],
        Rotation.from_euler("y", -20, degrees=True),
    )
    right_T_left = left_T_right.inv()
    return StereoHead(
        (2448, 2048),
        left,
        right,
        right_T_left.rotation.as_matrix(),
        np.asarray(right_T_left.translation),
        0.1,
    )


def cut_head() -> StereoHead:
    """The same head with sensors that end beside the plate: a third of the pixels to render and to
    search, and each hole as large as in the whole image."""
    whole = table_1_head()

    def cut(camera: CameraModel) -> CameraModel:
        matrix = camera.camera_matrix.copy()
        matrix[:2, 2] -= (624.0, 195.0)
        return replace(camera, camera_matrix=matrix)

    return replace(whole, image_size=(1200, 1600), left=cut(whole.left), right=cut(whole.right))


def write_stereo_head(path: Path, head: StereoHead, extra: Mapping[str, Any] | None = None) -> None:
    """A calibration file; ``extra`` adds keys such as the residuals of each view."""
    data = {**(extra or {}), **stereo_head_to_json(head)}
    path.write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")


def plate_facing(x_mm: float = 0.0, y_mm: float = 0.0, tilt_deg: float = 0.0) -> RigidTransform:
    """``camera_T_part`` of a plate 500 mm before the head, square to it, moved by x, y."""
    middle_T_part = pose_from_xyzabc([x_mm, y_mm, 0, 0, tilt_deg, 180 + tilt_deg])
    camera_T_middle = RigidTransform.from_components(
        [0.0, 0.0, 0.5], Rotation.from_euler("y", -10, degrees=True)
    )
    return camera_T_middle * middle_T_part


Pair = tuple[Image, Image]
"""What the left and the right camera see."""


@dataclass(frozen=True)
class Light:
    plate: float = 150.0
    dark: float = 30.0
    gradient_per_px: float = 0.0
    wall: float = 0.0
    """Grey level of the visible wall over the dark level, as a share of the contrast."""
    depth_m: float = 0.0
    cone: tuple[float, float] = (0.5, 1.0)
    blur_px: float = 1.0
    noise: float = 2.0
    texture: float = 0.0


def holes_triangle(kinds: tuple[str, str, str] = ("pin", "pin", "pin")) -> tuple[Hole, ...]:
    """Three holes about the part's origin, sides 100, 94 and 170 mm, as in the cell."""
    xy_mm = ((-26.7, -16.7), (-26.7, 83.3), (53.3, -66.7))
    diameters = {"pin": 6.0, "thread": 5.0, "countersink": 5.0, "disc": 20.0}
    return tuple(
        Hole(
            f"P{index}",
            kind,
            diameters[kind] * MM,
            np.array([x, y, 0.0]) * MM,
            10.0 * MM if kind == "countersink" else None,
        )
        for index, ((x, y), kind) in enumerate(zip(xy_mm, kinds, strict=True), start=1)
    )


def render(
    camera: CameraModel,
    size: tuple[int, int],
    camera_T_part: RigidTransform,
    holes: tuple[Hole, ...],
    light: Light,
    rng: np.random.Generator,
) -> Image:
    """One 8 bit image of the plate, noise included."""
    width, height = size
    shade = light.gradient_per_px / 100.0 * light.plate
    across, down = np.arange(width) - width / 2, 0.4 * (np.arange(height) - height / 2)
    image = light.plate + shade * (across + down[:, None])
    if any(hole.kind == "disc" for hole in holes):
        image[:] = light.dark
    for hole in holes:
        _draw(image, camera, camera_T_part, hole, light)
    if light.texture:
        rough = rng.normal(size=(height // 2, width // 8)).astype(np.float32)
        fine = cv2.resize(rough, (width, height), interpolation=cv2.INTER_LINEAR)
        image += fine * light.texture * 1.5
    half = light.noise**2 / 2
    # In single precision, which takes half the time and leaves grey levels as they are.
    clean = image.astype(np.float32)
    sigma = np.sqrt(half + np.float32(half / light.plate) * np.maximum(clean, 0))
    noisy = clean + sigma * rng.standard_normal(image.shape, dtype=np.float32)
    return np.asarray(np.clip(np.round(noisy), 0, 255), dtype=np.uint8)


def render_pair(
    head: StereoHead,
    camera_T_part: RigidTransform,
    holes: tuple[Hole, ...],
    light: Light,
    seed: int = 0,
) -> Pair:
    rng = np.random.default_rng(seed)
    left = render(head.left, head.image_size, camera_T_part, holes, light, rng)
    right_T_part = head.right_T_left * camera_T_part
    return left, render(head.right, head.image_size, right_T_part, holes, light, rng)


def _draw(
    image: Array, camera: CameraModel, camera_T_part: RigidTransform, hole: Hole, light: Light
) -> None:
    middle = project(camera, camera_T_part.apply(hole.position_m[None]))[0]
    distance_m = camera_T_part.apply(hole.position_m)[2]
    reach = camera.camera_matrix[0, 0] * (hole.countersink_m or hole.diameter_m) / 2 / distance_m
    half = int(reach + 8 + 4 * light.blur_px)
    x0, y0 = (int(value) - half for value in np.rint(middle))
    x1, y1 = x0 + 2 * half + 1, y0 + 2 * half + 1
    if x0 < 0 or y0 < 0 or x1 > image.shape[1] or y1 > image.shape[0]:
        return
    steps = (np.arange((x1 - x0) * SUB) + 0.5) / SUB - 0.5
    u, v = np.meshgrid(steps + x0, steps + y0)
    patch = image[y0:y1, x0:x1]
    plate = np.asarray(
        cv2.resize(patch, None, fx=SUB, fy=SUB, interpolation=cv2.INTER_LINEAR), dtype=np.float64
    )
    rays = np.column_stack(
        [undistort(camera, np.column_stack([u.ravel(), v.ravel()])), np.ones(u.size)]
    )
    grey = _shade(rays, camera_T_part, hole, light, plate.ravel()).reshape(u.shape)
    blurred = cv2.GaussianBlur(grey, (0, 0), light.blur_px * SUB, borderType=cv2.BORDER_REPLICATE)
    boxes = blurred.reshape(patch.shape[0], SUB, patch.shape[1], SUB).mean(axis=(1, 3))
    inner = slice(4, -4)
    patch[inner, inner] = boxes[inner, inner]


def _shade(
    rays: Array, camera_T_part: RigidTransform, hole: Hole, light: Light, plate: Array
) -> Array:
    part_T_camera = camera_T_part.inv()
    eye = np.asarray(part_T_camera.translation)
    direction = part_T_camera.rotation.apply(rays)
    on_plate = eye + direction * (-eye[2] / direction[:, 2])[:, None]
    x, y = (on_plate[:, :2] - hole.position_m[:2]).T
    radius = hole.diameter_m / 2
    inside = np.hypot(x, y) < radius
    if hole.kind == "disc":
        return np.where(inside, light.plate, light.dark)
    grey = plate.copy()
    if hole.countersink_m is not None:
        low, high = light.cone
        cone = np.hypot(x, y) < hole.countersink_m / 2
        bright = low + (high - low) * (0.5 + 0.5 * np.cos(np.arctan2(y, x) - 0.7))
        grey = np.where(cone, light.dark + bright * (plate - light.dark), grey)
    grey = np.where(inside, light.dark, grey)
    if light.wall and light.depth_m:
        low_point = eye + direction * ((-light.depth_m - eye[2]) / direction[:, 2])[:, None]
        lx, ly = (low_point[:, :2] - hole.position_m[:2]).T
        wall = inside & (np.hypot(lx, ly) > radius)
        grey = np.where(wall, light.dark + light.wall * (light.plate - light.dark), grey)
    return grey
