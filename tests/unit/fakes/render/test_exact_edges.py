"""Rendered edges against the analytic projection: noise-free, unquantised, better than 0.005 px."""

import numpy as np
import pytest

from fakes.render.model import SceneObject
from fakes.render.optics.lens import View
from fakes.render.options import RenderOptions
from fakes.render.picture import clean_picture
from fakes.world.scene import (
    HoleKind,
    SceneChessboard,
    SceneDisc,
    SceneHole,
    ScenePlate,
    SceneTargetBoard,
)
from tests.unit.fakes.render.edges import (
    Array,
    inner_strips,
    mean_in_strips,
    pose_at,
    project_cv,
    random_view,
)

LIMIT_PX = 0.001
"""The requirement is 0.005 px; what is reached is 0.0005 px at holes, 0.00005 px at boards."""
FIELD_PX = np.array([2448.0, 2048.0])
SIZE_PX = (150, 140)
DENSE = np.linspace(0, 2 * np.pi, 40_001)


def share_of(picture: Array, low: float, high: float) -> Array:
    """Coverage by the region with level ``low`` in surroundings with level ``high``."""
    return (high - np.asarray(picture, dtype=np.float64)) / (high - low)


def closed_curve_errors(share: Array, rim: Array) -> Array:
    """Edge errors, px, of all rows and columns on both sides of a rim that encloses ``share``."""
    errors = []
    for image, curve in ((share, rim), (share.T, rim[:, ::-1])):
        middle = round(curve[:, 0].mean())
        top, bottom = curve[curve[:, 1].argmin()], curve[curve[:, 1].argmax()]
        chord = np.interp(curve[:, 1], [top[1], bottom[1]], [top[0], bottom[0]])
        strips = inner_strips(curve)
        strips = strips[np.abs(strips - curve[:, 1].mean()) < 0.45 * np.ptp(curve[:, 1])]
        left = mean_in_strips(curve[curve[:, 0] <= chord], strips)
        right = mean_in_strips(curve[curve[:, 0] >= chord], strips)
        inside = (left < middle - 2) & (right > middle + 2)
        rows = image[strips]
        errors.append((middle + 0.5 - rows[:, : middle + 1].sum(axis=1) - left)[inside])
        errors.append((middle + 0.5 + rows[:, middle + 1 :].sum(axis=1) - right)[inside])
        assert inside.sum() > 15
    return np.concatenate(errors)


def picture_of(view: View, item: SceneObject, options: RenderOptions) -> Array:
    return np.asarray(clean_picture(view, (item,), options, 0), dtype=np.float64)


@pytest.mark.parametrize("kind", ["pin", "thread", "countersink"])
@pytest.mark.parametrize("recessed", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_hole_rim(kind: HoleKind, recessed: bool, seed: int) -> None:
    rng = np.random.default_rng([seed, recessed])
    view = random_view(rng, SIZE_PX, rng.uniform(0.05, 0.95, 2) * FIELD_PX)
    pose = pose_at(rng, view, 15)
    diameter_m = rng.uniform(4e-3, 8e-3)
    outer_m = {"pin": diameter_m, "thread": 1.12 * diameter_m, "countersink": 2 * diameter_m}[kind]
    outer_m = min(outer_m, 12e-3)
    place = tuple(rng.uniform(-1e-3, 1e-3, 2))
    hole = SceneHole("H", kind, place, diameter_m, outer_m, 15e-3, through=True)
    plate = ScenePlate("deck", pose, (0.4, 0.4), 15e-3, (hole,), seed)
    options = RenderOptions.clean(cone_grey=150.0, recessed_rims=recessed)
    share = share_of(picture_of(view, plate, options), options.dark_grey, options.plate_grey)
    depth_m = (outer_m - diameter_m) / 2 if recessed else 0.0
    rim = np.column_stack(
        [
            place[0] + diameter_m / 2 * np.cos(DENSE),
            place[1] + diameter_m / 2 * np.sin(DENSE),
            np.full_like(DENSE, -depth_m),
        ]
    )
    errors = closed_curve_errors(share, project_cv(view, pose, rim))
    assert np.abs(errors).max() < LIMIT_PX


@pytest.mark.parametrize("seed", range(6))
def test_outer_rim_of_a_countersink(seed: int) -> None:
    rng = np.random.default_rng([seed, 5])
    view = random_view(rng, SIZE_PX, rng.uniform(0.05, 0.95, 2) * FIELD_PX)
    pose = pose_at(rng, view, 15)
    hole = SceneHole("H", "countersink", (0.0, 0.0), 5e-3, 10e-3, 15e-3, through=True)
    plate = ScenePlate("deck", pose, (0.4, 0.4), 15e-3, (hole,), seed)
    options = RenderOptions.clean(cone_grey=18.0, recessed_rims=True)
    share = share_of(picture_of(view, plate, options), options.dark_grey, options.plate_grey)
    rim = 5e-3 * np.column_stack([np.cos(DENSE), np.sin(DENSE), np.zeros_like(DENSE)])
    assert np.abs(closed_curve_errors(share, project_cv(view, pose, rim))).max() < LIMIT_PX


@pytest.mark.parametrize("seed", range(6))
def test_disc(seed: int) -> None:
    rng = np.random.default_rng([seed, 6])
    view = random_view(rng, (230, 220), rng.uniform(0.1, 0.9, 2) * FIELD_PX)
    pose = pose_at(rng, view, 15)
    board = SceneTargetBoard(pose, (0.4, 0.3), 0.02, (SceneDisc("P5", (0.0, 0.0)),), seed)
    options = RenderOptions.clean()
    share = share_of(picture_of(view, board, options), options.white_grey, options.black_grey)
    rim = 0.01 * np.column_stack([np.cos(DENSE), np.sin(DENSE), np.zeros_like(DENSE)])
    assert np.abs(closed_curve_errors(share, project_cv(view, pose, rim))).max() < LIMIT_PX


@pytest.mark.parametrize("seed", range(10))
def test_chessboard_edges(seed: int) -> None:
    rng = np.random.default_rng([seed, 7])
    view = random_view(rng, (420, 400), rng.uniform(0.15, 0.85, 2) * FIELD_PX)
    pose = pose_at(rng, view, 15)
    square_m = rng.uniform(8e-3, 12e-3)
    bow_m = tuple(rng.uniform(-3e-4, 3e-4, 2))
    board = SceneChessboard(pose, (9, 6), square_m, (0.16, 0.12), bow_m, seed)
    options = RenderOptions.clean()
    white = share_of(picture_of(view, board, options), options.white_grey, options.black_grey)
    errors: list[float] = []
    for column in range(-2, 3):
        for row in range(-1, 2):
            for along_y in (True, False):
                errors.extend(_chess_edge_errors(view, board, white, column, row, along_y))
    assert len(errors) > 200
    assert np.abs(errors).max() < LIMIT_PX


def _chess_edge_errors(
    view: View, board: SceneChessboard, white: Array, column: int, row: int, along_y: bool
) -> Array:
    """Errors along one side of a field, in the strips across it, away from its ends."""
    t = np.linspace(0.2, 0.8, 4001)
    # inner corner lines lie at whole multiples along x (9 corners), at odd halves along y (6)
    if along_y:
        x, y = np.full_like(t, column), row - 0.5 + t
    else:
        x, y = column + t, np.full_like(t, row + 0.5)
    x, y = x * board.square_m, y * board.square_m
    half_x, half_y = board.size_m[0] / 2, board.size_m[1] / 2
    z = board.bow_m[0] * (1 - (x / half_x) ** 2) + board.bow_m[1] * (1 - (y / half_y) ** 2)
    curve = project_cv(view, board.camera_T_board, np.column_stack([x, y, z]))
    image = white
    if np.ptp(curve[:, 0]) > np.ptp(curve[:, 1]):
        curve, image = curve[:, ::-1], white.T
    if curve.min() < 30 or (curve.max(axis=0) > np.array(image.shape[::-1]) - 30).any():
        return np.zeros(0)
    strips = inner_strips(curve)
    expected = mean_in_strips(curve, strips)
    reach = 12
    errors = []
    for strip, position in zip(strips, expected, strict=True):
        start = round(position) - reach
        part = image[strip, start : round(position) + reach + 1]
        if part[-1] < part[0]:
            part = 1 - part
        errors.append(round(position) + reach + 0.5 - part.sum() - position)
    return np.asarray(errors)


def test_truth_is_where_opencv_projects_it() -> None:
    rng = np.random.default_rng(3)
    view = random_view(rng, (2448, 2048), FIELD_PX / 2)
    points = np.column_stack([rng.uniform(-0.15, 0.15, (50, 2)), np.full(50, 0.0)])
    pose = pose_at(rng, view, 10)
    from fakes.render.optics.surface import to_pixels

    difference = to_pixels(view, pose, points) - project_cv(view, pose, points)
    assert np.abs(difference).max() < 1e-9
