"""Blurred edges against brute force: 1024 cells a pixel, each in or out by its own ray."""

from collections.abc import Callable

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter
from scipy.spatial.transform import RigidTransform

from fakes.render.optics.lens import View
from fakes.render.options import RenderOptions
from fakes.render.picture import clean_picture
from fakes.world.scene import SceneChessboard, SceneDisc, SceneHole, ScenePlate, SceneTargetBoard
from tests.unit.fakes.render.edges import Array, pose_at, random_view, with_blur

CELLS = 32
SIZE_PX = (44, 40)
LIMIT = 3e-3
"""Share of the contrast. Convolving whole pixels would be off by up to 0.03."""
BLURS_PX = [0.7, pytest.param(1.0, marks=pytest.mark.long), 1.5]


def brute_force(
    view: View,
    pose: RigidTransform,
    inside: Callable[[Array, Array], NDArray[np.bool_]],
    margin: int = 6,
) -> Array:
    """Share of the region, blurred, of each pixel but for a margin."""
    width, height = view.size_px
    x = (np.arange(width * CELLS) + 0.5) / CELLS - 0.5
    y = (np.arange(height * CELLS) + 0.5) / CELLS - 0.5
    pixels = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 1, 2)
    (fx, fy), (cx, cy) = view.lens.focal_px, view.lens.centre_px
    matrix = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1.0]])
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 30, 1e-12)
    rays = cv2.undistortPoints(pixels, matrix, np.array(view.lens.distortion), criteria=criteria)[
        :, 0
    ]
    view_T_face = view.view_T_head * pose
    directions = view_T_face.rotation.inv().apply(np.column_stack([rays, np.ones(len(rays))]))
    origin = view_T_face.inv().translation
    places = origin[:2] - origin[2] * directions[:, :2] / directions[:, 2:]
    cells = inside(places[:, 0], places[:, 1]).reshape(height * CELLS, width * CELLS)
    smooth = gaussian_filter(cells.astype(float), view.lens.blur_px * CELLS, truncate=5.0)
    share = smooth.reshape(height, CELLS, width, CELLS).mean(axis=(1, 3))
    return np.asarray(share[margin:-margin, margin:-margin])


def share_of(picture: NDArray[np.floating], low: float, high: float, margin: int = 6) -> Array:
    inner = np.asarray(picture, dtype=float)[margin:-margin, margin:-margin]
    return (high - inner) / (high - low)


def scene_view(seed: int, blur_px: float) -> tuple[np.random.Generator, View, RigidTransform]:
    rng = np.random.default_rng([seed, 31])
    view = random_view(rng, SIZE_PX, rng.uniform([300, 300], [2100, 1700]))
    view = with_blur(view, blur_px)
    return rng, view, pose_at(rng, view, 20)


@pytest.mark.parametrize("blur_px", BLURS_PX)
@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.long)])
def test_hole(seed: int, blur_px: float) -> None:
    _, view, pose = scene_view(seed, blur_px)
    hole = SceneHole("H", "pin", (0.0, 0.0), 3e-3, None, 15e-3, through=True)
    options = RenderOptions.clean()
    picture = clean_picture(
        view, (ScenePlate("deck", pose, (0.3, 0.3), 15e-3, (hole,), 1),), options, 0
    )
    share = share_of(picture, options.dark_grey, options.plate_grey)
    expected = brute_force(view, pose, lambda x, y: np.hypot(x, y) < 1.5e-3)
    assert 0.2 < expected.mean() < 0.6
    assert np.abs(share - expected).max() < LIMIT


def test_disc() -> None:
    _, view, pose = scene_view(5, 0.9)
    board = SceneTargetBoard(pose, (0.3, 0.3), 3e-3, (SceneDisc("P1", (0.0, 0.0)),), 1)
    options = RenderOptions.clean()
    share = share_of(
        clean_picture(view, (board,), options, 0), options.white_grey, options.black_grey
    )
    expected = brute_force(view, pose, lambda x, y: np.hypot(x, y) < 1.5e-3)
    assert np.abs(share - expected).max() < LIMIT


@pytest.mark.parametrize("blur_px", BLURS_PX)
@pytest.mark.parametrize("seed", [0, *(pytest.param(n, marks=pytest.mark.long) for n in (1, 2))])
def test_chessboard_corner(seed: int, blur_px: float) -> None:
    _, view, pose = scene_view(seed, blur_px)
    board = SceneChessboard(pose, (9, 7), 8e-3, (0.12, 0.1), (0.0, 0.0), 1)
    options = RenderOptions.clean()
    share = share_of(
        clean_picture(view, (board,), options, 0), options.white_grey, options.black_grey
    )

    def white(x: Array, y: Array) -> NDArray[np.bool_]:
        # corners at whole multiples of the square on both axes; ten and eight fields
        return np.asarray((np.floor(x / 8e-3 + 5) + np.floor(y / 8e-3 + 4)) % 2 == 1)

    expected = brute_force(view, pose, white)
    assert 0.2 < expected.mean() < 0.8
    assert np.abs(share - expected).max() < LIMIT
