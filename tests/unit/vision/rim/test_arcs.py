"""Arcs that are off the circle of a rim: told from the rest, and measured without them."""

import cv2
import numpy as np
import pytest

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.lens import project
from cellctl.vision.camera.stereo_head import CameraModel
from cellctl.vision.measure import measure_pair
from cellctl.vision.rim.arcs import rest_waves, with_arcs
from cellctl.vision.rim.noise import PixelNoise, less_outliers, no_strokes
from tests.unit.vision.plates import Light, cut_head, holes_triangle, plate_facing, render_pair

STEP_GREY, BLUR_PX, NOISE_GREY = 100.0, 1.0, 2.0
PIXELS = 1800


def _fit(
    off_px: Array, seed: int, noise_grey: float = NOISE_GREY
) -> tuple[PixelNoise, Array, Array, Array]:
    """What a fit has whose edge stands off by so much at each degree, shape (360,)."""
    rng = np.random.default_rng(seed)
    azimuth = rng.uniform(-np.pi, np.pi, PIXELS)
    across_px = rng.uniform(-4.0, 4.0, PIXELS)
    density = np.exp(-0.5 * (across_px / BLUR_PX) ** 2) / (BLUR_PX * np.sqrt(2.0 * np.pi))
    degree = np.floor(np.degrees(azimuth)).astype(int) % 360
    residuals = -STEP_GREY * density * off_px[degree] + rng.normal(0.0, noise_grey, PIXELS)
    noise = less_outliers(residuals, np.full(PIXELS, noise_grey**2), no_strokes(PIXELS))
    by_radius = -STEP_GREY * density
    return with_arcs(noise, residuals, by_radius, azimuth), residuals, by_radius, azimuth


def _noise(off_px: Array, seed: int, noise_grey: float = NOISE_GREY) -> PixelNoise:
    return _fit(off_px, seed, noise_grey)[0]


def _dented(degrees: int, depth_px: float) -> Array:
    off_px = np.zeros(360)
    off_px[40 : 40 + degrees] = depth_px
    return off_px


@pytest.mark.parametrize("seed", range(5))
def test_a_dent_leaves_the_fit_and_the_rest_stays(seed: int) -> None:
    noise = _noise(_dented(60, 0.7), seed)
    assert noise.share_left_out == pytest.approx(60 / 360, abs=0.06)


@pytest.mark.parametrize("seed", range(5))
def test_a_dent_is_told_from_a_rim_that_it_has_pulled_along(seed: int) -> None:
    angle = np.radians(np.arange(360))
    pulled = _dented(60, 0.7) - 0.15 * np.cos(angle - np.radians(70.0)) - 0.1
    assert _noise(pulled, seed).share_left_out == pytest.approx(60 / 360, abs=0.06)


def test_a_circle_loses_no_arcs_wherever_it_lies() -> None:
    angle = np.radians(np.arange(360))
    moved = 0.2 * np.cos(angle) - 0.1 * np.sin(angle) + 0.05
    shares = [_noise(moved, seed).share_left_out for seed in range(5)]
    assert max(shares) < 0.05


def test_a_rim_that_is_worn_all_round_is_known_worse_and_loses_little() -> None:
    worn = np.repeat(np.random.default_rng(4).normal(0.0, 0.15, 36), 10)
    noise = _noise(worn, 7)
    assert noise.share_left_out < 0.1
    # Each arc is as sure as wear allows: 0.15 px and not the 0.02 px of its pixels.
    heights_grey = np.sqrt(noise.strokes.power(2).max(axis=1).toarray())
    assert len(heights_grey) == 36
    worn_px = heights_grey / (STEP_GREY / (BLUR_PX * np.sqrt(2.0 * np.pi)))
    assert float(np.median(worn_px)) == pytest.approx(0.15, rel=0.4)


def test_arcs_that_stay_are_no_circle_where_the_rim_waves() -> None:
    angle = np.radians(np.arange(360))
    waving = 0.25 * np.cos(2.0 * angle) + 0.15 * np.sin(3.0 * angle)
    assert all(rest_waves(*_fit(waving, seed)) for seed in range(5))
    assert not any(rest_waves(*_fit(_dented(60, 0.7), seed)) for seed in range(5))


def test_the_error_of_the_model_is_no_dent_in_images_with_hardly_any_noise() -> None:
    off_px = _dented(60, 0.012)
    assert _noise(off_px, 3, noise_grey=0.35).share_left_out == 0.0
    assert _noise(4.0 * off_px, 3, noise_grey=0.35).share_left_out > 0.1


def _with_dents(image: Image, camera: CameraModel, points_m: Array, light: Light) -> Image:
    """Dark dents of a few pixels in these places, as soft as the image."""
    dents = np.zeros(image.shape)
    for x, y in project(camera, points_m):
        at = (round(16.0 * float(x)), round(16.0 * float(y)))
        cv2.circle(dents, at, 16 * 4, 1.0, -1, cv2.LINE_AA, shift=4)
    soft = np.asarray(cv2.GaussianBlur(dents, (0, 0), light.blur_px))
    return np.asarray(np.rint(image + (light.dark - image) * soft), dtype=np.uint8)


def test_bores_with_a_dent_in_a_tenth_of_their_rim_are_measured_on_the_rest() -> None:
    head, pose, holes, light = cut_head(), plate_facing(3.0, -2.0, 2.0), holes_triangle(), Light()
    pair = render_pair(head, pose, holes, light, seed=5)
    rims_m = np.array([hole.position_m for hole in holes])
    rims_m += np.array([hole.diameter_m / 2.0 * np.array([0.6, 0.8, 0.0]) for hole in holes])
    seen = ((head.left, pose), (head.right, head.right_T_left * pose))
    left, right = (
        _with_dents(image, camera, camera_T_part.apply(rims_m), light)
        for image, (camera, camera_T_part) in zip(pair, seen, strict=True)
    )
    result = measure_pair(left, right, head, holes, camera_T_part=pose)
    for side, (camera, camera_T_part) in zip(("left_px", "right_px"), seen, strict=True):
        truth_px = project(camera, camera_T_part.apply([hole.position_m for hole in holes]))
        found_px = np.array([getattr(hole, side) for hole in result.holes])
        assert np.linalg.norm(found_px - truth_px, axis=1).max() < 0.04
    assert all(0.05 < hole.left_out < 0.3 for hole in result.holes)


def test_whole_rims_keep_all_their_arcs() -> None:
    head, pose, holes = cut_head(), plate_facing(3.0, -2.0, 2.0), holes_triangle()
    pair = render_pair(head, pose, holes, Light(), seed=5)
    result = measure_pair(*pair, head, holes, camera_T_part=pose)
    assert [hole.left_out for hole in result.holes] == [0.0, 0.0, 0.0]
