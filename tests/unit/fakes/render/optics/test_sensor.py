"""Noise, rounding and light against their laws."""

from dataclasses import replace
from math import sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from fakes.render import api
from fakes.render.optics.lens import views
from fakes.render.optics.sensor import exposed, noise_sigma
from fakes.render.options import RenderOptions
from fakes.render.picture import clean_picture

SHAPE = (700, 900)


def flat(grey: float) -> NDArray[np.float32]:
    return np.full(SHAPE, grey, dtype=np.float32)


@pytest.mark.parametrize("grey", [20.0, 90.3, 150.0, 210.7])
@pytest.mark.parametrize("noise", [1.0, 2.0, 4.0])
def test_mean_and_variance_of_the_noise(grey: float, noise: float) -> None:
    options = RenderOptions(noise_grey=noise, shot_share=0.5)
    image = exposed(flat(grey), options, np.random.default_rng(5)).astype(float)
    expected = noise**2 * (0.5 + 0.5 * grey / options.plate_grey) + 1 / 12
    count = image.size
    assert abs(image.mean() - grey) < 5 * sqrt(expected / count)
    assert abs(image.var() / expected - 1) < 5 * sqrt(2 / count) + 0.002


def test_noise_is_white_and_normal() -> None:
    options = RenderOptions(noise_grey=4.0)
    image = exposed(flat(150.0), options, np.random.default_rng(6)).astype(float) - 150.0
    count = image.size
    for shifted in (image[1:] * image[:-1], image[:, 1:] * image[:, :-1]):
        assert abs(shifted.mean()) / image.var() < 5 / sqrt(count)
    beyond = np.mean(np.abs(image) > 2.5 * image.std())
    assert beyond == pytest.approx(0.00887, rel=0.1)  # whole numbers: |x| > 10.5 of sigma 4.01


def test_frames_and_cameras_are_independent() -> None:
    options = RenderOptions(noise_grey=2.0)
    rng = np.random.default_rng(7)
    clean = (flat(150.0), flat(150.0))
    frames = [api.expose(clean, options, rng) for _ in range(2)]
    images = [image.astype(float).ravel() - 150.0 for pair in frames for image in pair]
    correlation = np.corrcoef(images) - np.eye(4)
    assert np.abs(correlation).max() < 5 / sqrt(images[0].size)


def test_full_scale_clips_and_no_noise_only_rounds() -> None:
    silent = RenderOptions.clean()
    rng = np.random.default_rng(8)
    assert exposed(flat(300.0), silent, rng).max() == 255
    assert exposed(flat(-3.0), silent, rng).max() == 0
    np.testing.assert_array_equal(exposed(flat(100.4), silent, rng), 100)
    assert noise_sigma(flat(100.0), silent).max() == 0


def test_gain_gradient_and_vignetting() -> None:
    stereo = api.nominal_head()
    plate = replace(api.nominal_plate("deck"), holes=())
    left, right = views(stereo)
    even = RenderOptions.clean()
    picture = clean_picture(right, (plate,), even, 0)
    middle = picture[1000:1040, 1500:1540]
    assert middle.mean() == pytest.approx(150.0 * right.lens.gain, rel=1e-4)
    shaded = clean_picture(left, (plate,), RenderOptions.clean(light_gradient_per_m=0.9), 0)
    ratio = shaded[300:1500, 1000:2300] / 150.0
    spread = np.ptp(ratio)
    assert 0.05 < spread < 0.35
    vignetted = clean_picture(left, (plate,), RenderOptions.clean(vignetting=0.12), 0)
    assert vignetted[1023, 1223] == pytest.approx(150.0, rel=1e-3)
    assert vignetted[0, -1] == pytest.approx(150.0 * 0.88, rel=1e-3)
