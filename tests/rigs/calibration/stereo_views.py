"""Views of a board at corner level, from a known head: no images."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.calibration.boards.board import BoardView, CalibrationBoard, Corners
from cellctl.geometry.pose import Array
from cellctl.vision.camera.lens import project
from cellctl.vision.camera.stereo_head import CameraModel, StereoHead

IMAGE_SIZE = (2448, 2048)
BOARD = CalibrationBoard(13, 10, 0.016)


def table_1_head() -> StereoHead:
    """Head I of the paper's table 1, with the cameras 20° apart."""
    left = CameraModel(
        np.array([[3580.35, 0, 1223.88], [0, 3578.42, 995.14], [0, 0, 1.0]]),
        np.array([-0.068, 0.166, 0.0004, 0.0002, -0.24]),
    )
    right = CameraModel(
        np.array([[3581.49, 0, 1229.47], [0, 3580.91, 993.17], [0, 0, 1.0]]),
        np.array([-0.055, -0.02, -0.0006, -0.0002, 0.3]),
    )
    rotation = Rotation.from_euler("y", 20, degrees=True).as_matrix()
    return StereoHead(IMAGE_SIZE, left, right, rotation, np.array([-0.176, 0.0003, 0.0317]), 0.0)


@dataclass(frozen=True)
class Bench:
    views: list[BoardView]
    points_m: Array
    """Test points in the left camera, all over the common field."""


def bow(board: CalibrationBoard, sag_m: float) -> Array:
    """Corners of a board whose middle stands ``sag_m`` above its ends, shape (n, 3)."""
    corners = board.corners_m
    half = np.abs(corners).max(axis=0)
    corners[:, 2] = sag_m * (1 - (corners[:, 0] / half[0]) ** 2)
    return corners


def misprint(rng: np.random.Generator, corners: Array, sigma_m: float) -> Array:
    """Displacements of corners in the plane that keep the scale of the print, shape (n, 3)."""
    off = np.zeros_like(corners)
    off[:, :2] = rng.normal(0, sigma_m, (len(corners), 2))
    flat = corners * [1, 1, 0]
    return np.asarray(off - flat * float((off * flat).sum() / (flat**2).sum()))


def make_views(
    rng: np.random.Generator,
    count: int,
    *,
    noise_px: float = 0.05,
    sag_m: float = 0.0,
    board: CalibrationBoard = BOARD,
    head: StereoHead | None = None,
    print_error_m: float = 0.0,
) -> list[BoardView]:
    head = head or table_1_head()
    corners = bow(board, sag_m)
    if print_error_m:
        corners += misprint(rng, corners, print_error_m)
    views: list[BoardView] = []
    while len(views) < count:
        view = _random_view(rng, f"view-{len(views):02d}", corners, head, noise_px)
        if min(len(view.left.ids), len(view.right.ids)) >= len(corners) // 2:
            views.append(view)
    return views


def _random_view(
    rng: np.random.Generator, name: str, corners: Array, head: StereoHead, noise_px: float
) -> BoardView:
    tilt = rng.uniform(-30, 30, 2)
    roll = rng.uniform(-180, 180)
    left_r_board = Rotation.from_euler("zyx", [roll, tilt[0], tilt[1]], degrees=True)
    # The head's axes meet about 500 mm ahead, 10° to the side of each camera.
    distance = rng.uniform(0.42, 0.56)
    middle = np.array([rng.uniform(-0.09, 0.09), rng.uniform(-0.08, 0.08), distance])
    in_left = left_r_board.apply(corners) + middle
    in_right = in_left @ head.rotation.T + head.translation_m
    sides = [(head.left, in_left), (head.right, in_right)]
    return BoardView(name, *(_image(rng, model, points, noise_px) for model, points in sides))


def _image(rng: np.random.Generator, model: CameraModel, points: Array, noise_px: float) -> Corners:
    pixels = project(model, points)
    inside = (pixels > 5).all(axis=1) & (pixels < np.array(IMAGE_SIZE) - 6).all(axis=1)
    ids = np.flatnonzero(inside)
    return Corners(ids, pixels[ids] + rng.normal(0, noise_px, (len(ids), 2)))


def volume_points() -> Array:
    """A grid of points about the working distance, shape (n, 3), in the left camera."""
    x, y, z = np.meshgrid(
        np.linspace(-0.09, 0.09, 5), np.linspace(-0.08, 0.08, 5), np.linspace(0.47, 0.53, 3)
    )
    return np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)


def hanging_together(
    views: list[BoardView], rng: np.random.Generator, sigma_px: float
) -> list[BoardView]:
    """The same views with an error that is smooth in each image and other in each.

    So are the errors of real views: a board that bends otherwise, an edge that is blurred one way.
    """

    def moved(corners: Corners) -> Corners:
        x, y = ((corners.pixels - np.array(IMAGE_SIZE) / 2) / 1200).T
        terms = np.stack([np.ones_like(x), x, y, x * y, x**2, y**2, x**3, y**3, x**2 * y, x * y**2])
        size = (len(terms), 2)
        return Corners(corners.ids, corners.pixels + terms.T @ rng.normal(0, sigma_px, size))

    return [BoardView(view.name, moved(view.left), moved(view.right)) for view in views]
