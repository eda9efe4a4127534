"""Plates with drawn holes before heads of several sizes, with exact truth."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation

from benchmarks.metrology.drawn_conditions import Condition
from benchmarks.metrology.drawn_looks import LOOKS, PLATE, Array, Look, disc
from cellctl.vision.camera.stereo_head import CameraModel, StereoHead
from cellctl.vision.features.hole import Hole
from tests.rigs.metrology.views import HeadView

_SUB = 8
_MARGIN_PX = 8
_NO_CONDITION = Condition()
_LAYOUT_M = np.array([[-0.055, -0.032, 0.0], [0.058, -0.040, 0.0], [-0.020, 0.055, 0.0]])
_DIAMETERS_M = (5e-3, 6e-3, 8e-3)


@dataclass(frozen=True, slots=True)
class Scene:
    """One stereo pair of a plate and what is true of it."""

    view: HeadView
    steps: dict[str, float]
    """Typical difference of grey across each rim."""


@dataclass(frozen=True, slots=True)
class _Rig:
    size_px: tuple[int, int]
    focal_px: float
    baseline_m: float
    toe_in_deg: float
    distance_m: float
    distortion: tuple[float, float, float, float, float]
    scale: float
    """Scale of the layout."""


_RIGS = (
    _Rig((2448, 2048), 3580.0, 0.179, 20.0, 0.50, (-0.07, 0.17, 4e-4, -3e-4, 0.0), 1.25),
    _Rig((1600, 1200), 2300.0, 0.150, 20.0, 0.42, (-0.12, 0.10, 5e-4, -4e-4, 0.0), 1.0),
    _Rig((1280, 1024), 1900.0, 0.070, 0.0, 0.38, (-0.15, 0.08, 3e-4, 4e-4, 0.0), 0.8),
    _Rig((1600, 1200), 2400.0, 0.110, 9.0, 0.42, (-0.08, 0.05, 3e-4, -2e-4, 0.0), 0.8),
)


def drawn_scene(look: str, seed: int, condition: Condition = _NO_CONDITION) -> Scene:
    """A random pose of a plate with three holes, the first one an even disc."""
    rng = np.random.default_rng([seed, list(LOOKS).index(look)])
    rig = _RIGS[seed % len(_RIGS)]
    looks = [condition.worn(one(rng), rng) for one in (disc, LOOKS[look], LOOKS[look])]
    diameters_m = rng.choice(_DIAMETERS_M, len(looks))
    holes = tuple(
        Hole(f"H{index}", one.kind, float(diameter_m), place * rig.scale)
        for index, (one, diameter_m, place) in enumerate(
            zip(looks, diameters_m, _LAYOUT_M, strict=True), start=1
        )
    )
    head, pose = _head(rig), _pose(rig, rng, condition.tilt_deg)
    cameras = ((head.left, pose), (head.right, head.right_T_left * pose))
    spread = condition.spread(rng, _SUB)
    at_m = np.array([hole.position_m for hole in holes])
    images, truth_px = [], []
    for camera, camera_T_part in cameras:
        image = np.full(rig.size_px[::-1], PLATE)
        for hole, one in zip(holes, looks, strict=True):
            seat = RigidTransform.from_translation(hole.position_m)
            rim = _Rim(camera, camera_T_part * seat, hole.diameter_m / 2.0)
            _draw(image, rim, one, spread)
        images.append(condition.sensor(condition.light(image, rng), rng))
        truth_px.append(_project(camera, camera_T_part.apply(at_m)))
    names = [hole.name for hole in holes]
    view = HeadView(
        head,
        holes,
        pose,
        (images[0], images[1]),
        dict(zip(names, zip(*truth_px, strict=True), strict=True)),
        dict(zip(names, pose.apply(at_m), strict=True)),
        _width_px(spread),
    )
    return Scene(view, dict(zip(names, [one.step for one in looks], strict=True)))


def _head(rig: _Rig) -> StereoHead:
    width, height = rig.size_px
    matrix = np.array(
        [
            [rig.focal_px, 0.0, width / 2 + 7.0],
            [0.0, rig.focal_px * 1.001, height / 2 - 9.0],
            [0, 0, 1],
        ]
    )
    camera = CameraModel(matrix, np.array(rig.distortion))
    turn = Rotation.from_euler("y", rig.toe_in_deg, degrees=True).as_matrix()
    return StereoHead(
        rig.size_px, camera, camera, turn, -turn @ np.array([rig.baseline_m, 1e-3, 0.0]), 0.0
    )


def _width_px(spread: NDArray[np.float32]) -> float:
    """Standard deviation along one axis, mean of both."""
    steps = (np.arange(len(spread)) - len(spread) // 2) / _SUB
    squares = float((spread.sum(axis=0) + spread.sum(axis=1)) @ steps**2)
    return float(np.sqrt(squares / (2.0 * float(spread.sum()))))


def _pose(rig: _Rig, rng: np.random.Generator, more_deg: tuple[float, float]) -> RigidTransform:
    """A plate that looks at the head, with z into the part: the drawing does not say so."""
    across_m = 0.0 if rig.toe_in_deg else rig.baseline_m / 2
    tilt = Rotation.from_rotvec(rng.uniform(-0.12, 0.12, 3) * [1.0, 1.0, 20.0])
    middle_m = np.array([across_m, 0.0, rig.distance_m * rng.uniform(0.97, 1.04)])
    if more_deg[1] > 0.0:
        way = rng.uniform(-np.pi, np.pi)
        size = np.radians(rng.uniform(*more_deg))
        more = Rotation.from_rotvec(size * np.array([np.cos(way), np.sin(way), 0.0]))
        tilt = more * tilt
    return RigidTransform.from_components(middle_m, tilt)


@dataclass(frozen=True, slots=True)
class _Rim:
    camera: CameraModel
    camera_T_rim: RigidTransform
    radius_m: float


def _draw(image: Array, rim: _Rim, look: Look, spread: NDArray[np.float32]) -> None:
    """Ray by ray in a window of the image, blurred at that scale, then gathered to pixels."""
    camera, pose = rim.camera, rim.camera_T_rim
    middle_m = pose.translation
    radius_px = camera.camera_matrix[0, 0] * rim.radius_m / middle_m[2]
    half = int(1.1 * look.reach * radius_px + len(spread) / (2 * _SUB)) + _MARGIN_PX
    x0, y0 = np.rint(_project(camera, middle_m[None])[0]).astype(int) - half
    size = 2 * half + 1
    steps = (np.arange(size * _SUB) + 0.5) / _SUB - 0.5
    u, v = np.meshgrid(steps + x0, steps + y0)
    pixels = np.stack([u.ravel(), v.ravel()], axis=1)[:, None]
    rays = cv2.undistortPoints(pixels, camera.camera_matrix, camera.distortion)[:, 0]
    turned = pose.rotation.inv().apply(np.column_stack([rays, np.ones(len(rays))]))
    eye_m, slopes = pose.inv().translation, turned[:, :2] / turned[:, 2:]
    met_m = eye_m[:2] - slopes * eye_m[2]
    grey = look.grey(met_m.T / rim.radius_m, slopes.T)
    fine = np.where(np.isnan(grey), PLATE, grey).reshape(u.shape)
    soft = cv2.filter2D(fine, -1, spread, borderType=cv2.BORDER_REPLICATE)
    image[y0 : y0 + size, x0 : x0 + size] = soft.reshape(size, _SUB, size, _SUB).mean(axis=(1, 3))


def _project(camera: CameraModel, points_m: Array) -> Array:
    pixels, _ = cv2.projectPoints(
        np.ascontiguousarray(points_m, dtype=float).reshape(-1, 1, 3),
        np.zeros(3),
        np.zeros(3),
        camera.camera_matrix,
        camera.distortion,
    )
    return np.asarray(pixels[:, 0], dtype=float)
