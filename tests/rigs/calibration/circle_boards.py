"""Rendered grids of circles before a head, with the truth of where their centres are seen."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.boards.board import CalibrationBoard, Circles
from cellctl.calibration.boards.board_images import BoardImages
from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from fakes.render import api
from fakes.render.optics.lens import project
from fakes.world.scene import (
    CameraScene,
    LensTruth,
    MonoTruth,
    SceneDisc,
    SceneTargetBoard,
    StereoTruth,
)

STAGGERED = CalibrationBoard(4, 11, 0.012, circles=Circles(0.0105, asymmetric=True))
"""Nothing of it comes back after a turn."""
GRID = CalibrationBoard(9, 7, 0.02, circles=Circles(0.013))
BOARD_FROM_DRAWN = RigidTransform.from_rotation(Rotation.from_euler("x", 180, degrees=True))
"""z of a rendered board points towards the camera, that of a calibration board away from it."""


def head(shrink: float = 2.0) -> StereoTruth:
    """The nominal head with fewer pixels: quick to render. Its circles are seen smaller."""
    full = api.nominal_head()

    def smaller(lens: LensTruth) -> LensTruth:
        fx, fy = lens.focal_px
        cx, cy = lens.centre_px
        return replace(
            lens, focal_px=(fx / shrink, fy / shrink), centre_px=(cx / shrink, cy / shrink)
        )

    width, height = full.image_size_px
    size = (round(width / shrink), round(height / shrink))
    return StereoTruth(size, smaller(full.left), smaller(full.right), full.right_T_left)


@dataclass(frozen=True, slots=True, eq=False)
class SeenGrid:
    """One exposure of a grid of circles by the left camera."""

    image: Image
    camera_T_board: RigidTransform
    """Pose of the board's own frame in the camera."""
    centres_px: Array
    """Where the centres of the circles are seen, shape (n, 2)."""


def seen_grid(
    stereo: StereoTruth,
    board: CalibrationBoard,
    tilt_deg: Sequence[float],
    rng: np.random.Generator,
) -> SeenGrid:
    """White circles on a dark plate; ``tilt_deg`` about x, y and z of the camera."""
    pose, scene = _scene(board, tilt_deg, rng)
    optics = MonoTruth(stereo.image_size_px, stereo.left, colour=False)
    seed = int(rng.integers(2**31))
    (image,) = api.render_scene(CameraScene("left", 0.0, optics, (scene,), 1, seed))
    camera_T_board = pose * BOARD_FROM_DRAWN
    centres_px = project(stereo.left, camera_T_board.apply(board.corners_m))
    return SeenGrid(image, camera_T_board, centres_px)


def seen_by_both(
    stereo: StereoTruth,
    board: CalibrationBoard,
    tilt_deg: Sequence[float],
    rng: np.random.Generator,
    name: str,
) -> BoardImages:
    """The same by both cameras."""
    _, scene = _scene(board, tilt_deg, rng)
    left, right = api.render_pair(stereo, [scene], rng=rng)
    return BoardImages(name, left, right)


def _scene(
    board: CalibrationBoard, tilt_deg: Sequence[float], rng: np.random.Generator
) -> tuple[RigidTransform, SceneTargetBoard]:
    if board.circles is None:
        raise ValueError("not a grid of circles")
    shift_m = (*rng.uniform(-0.04, 0.04, 2), rng.uniform(-0.03, 0.06))
    about_x, about_y, about_z = tilt_deg
    pose = api.facing_pose(shift_m=shift_m, tilt_deg=(about_x, about_y, about_z))
    places = np.asarray(BOARD_FROM_DRAWN.apply(board.corners_m), dtype=float).reshape(-1, 3)
    discs = tuple(SceneDisc(f"{i}", (float(x), float(y))) for i, (x, y, _) in enumerate(places))
    sides = 2 * np.abs(places[:, :2]).max(axis=0) + 2.5 * board.circles.diameter_m
    side_x, side_y = sides.tolist()
    return pose, SceneTargetBoard(pose, (side_x, side_y), board.circles.diameter_m, discs, 1)


def dark_circles(image: Image) -> Image:
    """The negative: dark circles on a bright board."""
    return np.asarray(255 - image, dtype=np.uint8)
