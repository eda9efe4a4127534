"""How sure a fitted rim is: beside the noise, what the model leaves and which arcs have left it."""

from dataclasses import replace

import numpy as np
import pytest

from cellctl.geometry.pose import Array
from cellctl.vision.rim.covariance import misfit_beyond_model, with_covariance
from cellctl.vision.rim.light import LightModel
from cellctl.vision.rim.shape import RimShape, borders
from cellctl.vision.rim.solver import RimFit, full_fit, single_image_problem
from tests.unit.vision.rim.test_shape import SHAPES, pixels_round

DISTURBED = 5.0
NO_SPREAD: Array = np.zeros((2, 2))


def fitted_bore(off_px: float, noise_grey: float, wall_ratio: float | None = None) -> RimFit:
    """A dark bore of which a sixth of the rim lies so much farther out, fitted as a circle."""
    shape = SHAPES["bore"]
    pixels = pixels_round(shape.centre)
    (rim,) = borders(pixels, shape)
    x, y = pixels.points - shape.centre[:, None]
    there = np.abs(np.arctan2(y, x) - 1.0) < np.pi / 6.0
    outside = rim.outside + rim.by_shape[2] * there * off_px * pixels.unit_px
    noise = np.random.default_rng(1).normal(0.0, noise_grey, len(outside))
    seen = replace(pixels, grey=40.0 + 140.0 * outside + noise)
    start = RimShape(shape.centre, shape.radius, 1.0, wall_ratio)
    problem = single_image_problem(seen, start, LightModel(), shape.radius, None)
    return full_fit(problem, start.vector)


def misfits(fit: RimFit) -> tuple[float, float]:
    return with_covariance(fit, NO_SPREAD).misfit, misfit_beyond_model(fit)


def test_without_noise_the_error_of_the_model_is_no_disturbance() -> None:
    over_noise, over_both = misfits(fitted_bore(0.014, 0.2))
    assert over_both < DISTURBED < over_noise


def test_a_dent_exceeds_noise_and_the_error_of_the_model() -> None:
    assert min(misfits(fitted_bore(0.3, 2.0))) > DISTURBED


def test_in_noisy_images_the_error_of_the_model_hardly_counts() -> None:
    over_noise, over_both = misfits(fitted_bore(0.0, 3.0))
    assert over_both == pytest.approx(over_noise, rel=0.35)
    assert over_both < over_noise


@pytest.mark.parametrize(("share", "factor"), [(0.0, 1.0), (0.25, 1.25), (0.4, 5.0)])
def test_the_more_of_a_rim_has_left_the_more_doubtful_is_the_rest(
    share: float, factor: float
) -> None:
    fit = fitted_bore(0.0, 1.5)
    noise = fit.solution.noise
    gone = np.arange(len(noise.left_out)) < round(share * len(noise.left_out))
    less = replace(fit, solution=replace(fit.solution, noise=replace(noise, left_out=gone)))
    grown = with_covariance(less, NO_SPREAD).covariance
    whole = with_covariance(fit, NO_SPREAD).covariance
    np.testing.assert_allclose(grown, whole * factor, rtol=0.02)


def test_the_crescent_of_a_wall_is_as_wide_as_it_is_seen() -> None:
    assert fitted_bore(0.0, 1.5).crescent_px == np.inf
    fit = fitted_bore(0.0, 1.5, wall_ratio=0.02)
    (shape,) = fit.shapes
    ratio = shape.wall_ratio or 0.0
    low_centre, low_radius = shape.centre / (1.0 + ratio), shape.radius / (1.0 + ratio)
    farthest = np.linalg.norm(shape.centre) + shape.radius
    lower = np.linalg.norm(low_centre) + low_radius
    unit_px = fit.problem.unit_px
    assert fit.crescent_px == pytest.approx(float(farthest - lower) / unit_px)
