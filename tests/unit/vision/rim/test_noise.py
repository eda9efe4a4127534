"""Strokes of a machined face: found, and weighed as the correlated noise that they are."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.plane_patch import X_AXIS, PlanePatch, plane_basis, plane_patch
from cellctl.vision.rim.noise import PixelNoise, noise_of, stroke_pattern, surface_lay
from tests.rigs.sweeps import examples
from tests.unit.vision.plates import table_1_head

MIDDLE_PX = np.array([1200.0, 1000.0])


def _patch() -> PlanePatch:
    normal = np.array([0.0, 0.0, 1.0])
    return plane_patch(table_1_head().left, normal, plane_basis(normal, X_AXIS), MIDDLE_PX, 60.0)


def _brushed(angle_deg: float, height_grey: float, noise_grey: float, seed: int) -> Image:
    """A face brushed along ``angle_deg``, image y down."""
    rng = np.random.default_rng(seed)
    profile = cv2.GaussianBlur(rng.normal(0.0, 1.0, (1, 4000)), (0, 0), 1.0)[0]
    profile *= height_grey / profile.std()
    rows, columns = np.indices((2048, 2448))
    angle = np.radians(angle_deg)
    position = -np.sin(angle) * columns + np.cos(angle) * rows
    image = 120.0 + np.interp(position + 1500.0, np.arange(4000), profile)
    image += rng.normal(0.0, noise_grey, image.shape)
    grey: Image = np.clip(np.rint(image), 0, 255).astype(np.uint8)
    return grey


@pytest.mark.parametrize("angle_deg", [0.0, 30.0, 100.0])
def test_the_lay_is_found_to_a_degree(angle_deg: float) -> None:
    across = surface_lay(_brushed(angle_deg, 4.0, 2.0, 3), _patch(), MIDDLE_PX, 25.0)
    assert across is not None
    wanted = np.array([-np.sin(np.radians(angle_deg)), np.cos(np.radians(angle_deg))])
    assert abs(across @ wanted) > np.cos(np.radians(1.0))


def test_noise_alone_has_no_lay() -> None:
    found = [
        surface_lay(_brushed(0.0, 1e-3, 2.0, seed), _patch(), MIDDLE_PX, 25.0) for seed in (1, 2)
    ]
    assert found == [None, None]


def _offsets(rng: np.random.Generator) -> Array:
    angle, radius = rng.uniform(0.0, 2.0 * np.pi, 400), rng.uniform(15.0, 25.0, 400)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)])


@settings(max_examples=examples(25), deadline=None)
@given(seed=st.integers(0, 2**31), height=st.floats(0.1, 8.0))
def test_weighing_is_the_inverse_of_the_covariance(seed: int, height: float) -> None:
    rng = np.random.default_rng(seed)
    pattern = stroke_pattern(_offsets(rng), np.array([0.0, 1.0]), 20.0) * height
    weights = rng.uniform(0.1, 1.0, 400)
    rows = rng.normal(size=(3, 400))
    dense = np.diag(1.0 / weights) + (pattern.T @ pattern).toarray()
    np.testing.assert_allclose(
        PixelNoise.of(weights, pattern).weigh(rows), np.linalg.solve(dense, rows.T).T, atol=1e-8
    )


def test_noise_and_strokes_are_told_apart() -> None:
    rng = np.random.default_rng(5)
    offsets = _offsets(rng)
    pattern = stroke_pattern(offsets, np.array([0.0, 1.0]), 20.0)
    heights = rng.normal(0.0, 4.0, pattern.shape[0] // 2)
    residuals = heights @ pattern[: len(heights)] + rng.normal(0.0, 1.5, 400)
    noise = noise_of(residuals, np.ones(400), pattern)
    assert np.median(noise.weights) ** -0.5 == pytest.approx(1.5, rel=0.35)
    assert noise.own(residuals).std() < 0.5 * residuals.std()


def test_without_strokes_in_the_residuals_none_are_assumed() -> None:
    rng = np.random.default_rng(6)
    pattern = stroke_pattern(_offsets(rng), np.array([0.0, 1.0]), 20.0)
    counted = [
        noise_of(rng.normal(0.0, 2.0, 400), np.ones(400), pattern).strokes.shape[0]
        for _ in range(20)
    ]
    assert counted.count(0) >= 5
