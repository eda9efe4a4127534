"""Lens inversion and the Chebyshev expansion against direct computation."""

import cv2
import numpy as np
import pytest

from fakes.render import api
from fakes.render.optics.lattice import NODES_FULL, Window
from fakes.render.optics.lens import project, undistort, views
from fakes.render.optics.surface import is_seen, meet_surface, surface_map, to_pixels

PX_M = 0.5 / 3580


def test_undistort_inverts_project() -> None:
    rng = np.random.default_rng(1)
    for view in views(api.nominal_head()):
        pixels = rng.uniform([0, 0], view.size_px, (500, 2))
        rays = np.column_stack([undistort(view.lens, pixels), np.ones(500)])
        np.testing.assert_allclose(project(view.lens, 0.7 * rays), pixels, atol=1e-8)


def test_undistort_agrees_with_opencv() -> None:
    left, _ = views(api.nominal_head())
    pixels = np.random.default_rng(2).uniform([0, 0], left.size_px, (200, 2))
    (fx, fy), (cx, cy) = left.lens.focal_px, left.lens.centre_px
    matrix = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1.0]])
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 100, 1e-14)
    expected = cv2.undistortPoints(
        pixels[:, None], matrix, np.array(left.lens.distortion), criteria=criteria
    )
    np.testing.assert_allclose(undistort(left.lens, pixels), expected[:, 0], atol=1e-9)


def test_folded_lens_is_refused() -> None:
    left, _ = views(api.nominal_head())
    from dataclasses import replace

    folded = replace(left.lens, distortion=(-4.0, 0.0, 0.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="cannot be inverted"):
        undistort(folded, np.array([[0.0, 0.0], [2447.0, 2047.0]]))


@pytest.mark.parametrize("bow_m", [0.0, 1e-3])
def test_full_image_expansion_is_exact_to_a_millionth_of_a_pixel(bow_m: float) -> None:
    rng = np.random.default_rng(3)
    _, right = views(api.nominal_head())
    pose = api.facing_pose(tilt_deg=(25.0, -30.0, 40.0))

    def height(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.asarray(bow_m * (1 - (x / 0.14) ** 2 - (y / 0.11) ** 2))

    x, y = surface_map(right, pose, Window.full(right), z_m=height, nodes=NODES_FULL)
    columns, rows = rng.integers(0, 2448, 300), rng.integers(0, 2048, 300)
    pixels = np.column_stack([columns, rows]).astype(float)
    places = np.column_stack([x[rows, columns], y[rows, columns]])
    points = np.column_stack([places, height(*places.T)])
    assert np.abs(to_pixels(right, pose, points) - pixels).max() < 1e-6


def test_window_cells_lie_where_they_should() -> None:
    left, _ = views(api.nominal_head())
    pose = api.facing_pose(tilt_deg=(5.0, 8.0, 0.0))
    window = Window(700, 300, 60, 40, sub=4)
    x, y = surface_map(left, pose, window)
    assert x.shape == (160, 240)
    pixel = np.array([[700 + 1 + 0.125, 300 - 0.5 + 0.125]])  # second row of pixel 701: cell (6, 0)
    expected = meet_surface(left.view_T_head * pose, undistort(left.lens, pixel), 0.0)[0]
    assert np.abs(np.array([x[0, 6], y[0, 6]]) - expected).max() < 1e-6 * PX_M


def test_faces_turned_away_or_grazing_are_not_seen() -> None:
    left, right = views(api.nominal_head())
    assert is_seen(left, api.facing_pose())
    assert is_seen(right, api.facing_pose(tilt_deg=(30.0, 0.0, 0.0)))
    assert not is_seen(left, api.facing_pose(tilt_deg=(180.0, 0.0, 0.0)))
    assert not is_seen(left, api.facing_pose(tilt_deg=(80.0, 0.0, 0.0)))
    assert not is_seen(left, api.facing_pose(shift_m=(0.0, 0.0, -1.5)))
