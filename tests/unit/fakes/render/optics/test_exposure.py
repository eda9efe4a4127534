"""What one exposure does to the clean picture, and what a lens does that no polynomial follows."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ndtr

from fakes.render import api
from fakes.render.look import options_of
from fakes.render.optics.exposure import taken
from fakes.render.optics.lens import distort, project, undistort
from fakes.render.worker import render_frame
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.world.scene import CameraScene, Exposure

FOCAL_PX = 3580.0


def spot(sigma_px: float = 3.0) -> np.ndarray:
    y, x = np.mgrid[-30:31, -30:31]
    image: np.ndarray = (100 * np.exp(-0.5 * (x**2 + y**2) / sigma_px**2)).astype(np.float32)
    return image


def moments(picture: np.ndarray) -> tuple[float, float, float]:
    """Sum, mean of x, variance of x."""
    x = np.arange(-30, 31)
    rows = picture.sum(axis=0).astype(float)
    mean = float((rows * x).sum() / rows.sum())
    return float(rows.sum()), mean, float((rows * (x - mean) ** 2).sum() / rows.sum())


def test_sway_shifts_smear_widens_and_gain_brightens() -> None:
    picture = spot()
    total, mean, variance = moments(picture)
    exposure = Exposure((0.1 / FOCAL_PX, 0.0), (0.2 / FOCAL_PX, 0.0), 1.02)
    got_total, got_mean, got_variance = moments(taken(picture, exposure, FOCAL_PX))
    assert got_total == pytest.approx(1.02 * total, rel=1e-5)
    assert got_mean - mean == pytest.approx(0.1, abs=1e-4)
    assert got_variance - variance == pytest.approx(0.2**2, abs=2e-3)


def test_a_sharp_edge_follows_the_sway_in_full() -> None:
    x = np.arange(-30.0, 31.0)
    edge, slope = ndtr(x) * 100.0, np.exp(-0.5 * x**2) * 100.0 / np.sqrt(2.0 * np.pi)
    picture = np.tile(edge, (61, 1)).astype(np.float32)
    exposure = Exposure((0.05 / FOCAL_PX, 0.0), (1e-9, 0.0))
    change = taken(picture, exposure, FOCAL_PX)[30].astype(float) - edge
    # Least squares, as whoever measures the edge in noise: its place, not its centre of light.
    assert -(change @ slope) / (slope @ slope) == pytest.approx(0.05, rel=0.03)


def test_a_plain_exposure_is_the_picture_itself() -> None:
    picture = spot()
    assert taken(picture, Exposure(), FOCAL_PX) is picture


def test_the_same_scene_is_taken_brighter() -> None:
    stereo = replace(api.nominal_head(), image_size_px=(160, 120))
    scene = CameraScene("head_1", 0.0, stereo, (api.nominal_plate("deck"),), 1, 5)
    options = api.RenderOptions.clean()
    plain = np.frombuffer(render_frame(scene, options).payload, dtype=np.uint8)
    bright = render_frame(replace(scene, exposure=Exposure(gain=1.1)), options)
    means = [plain.mean(), np.frombuffer(bright.payload, dtype=np.uint8).mean()]
    assert means[1] == pytest.approx(1.1 * means[0], rel=0.01)


def test_misfit_has_its_size_and_can_be_inverted() -> None:
    lens = api.nominal_head().left
    waved = replace(lens, misfit=(0.05 / FOCAL_PX, 0.4, 1.1))
    x, y = (axis.ravel() for axis in np.meshgrid(*[np.linspace(-0.3, 0.3, 61)] * 2))
    offset_px = (np.array(distort(waved, x, y)) - np.array(distort(lens, x, y))) * FOCAL_PX
    assert np.abs(offset_px).max() == pytest.approx(0.05, rel=0.02)
    points = np.column_stack([x, y, np.ones_like(x)])
    np.testing.assert_allclose(undistort(waved, project(waved, points)), points[:, :2], atol=1e-12)


def test_glare_and_tilt_are_options_of_the_scenario(shipped_scenario: DeckScenario) -> None:
    rendering = shipped_scenario.rendering
    assert rendering is not None
    plain = options_of(rendering)
    options = options_of(rendering, glare=0.2, tilt_shading=1.0)
    assert options.gloss == pytest.approx(plain.gloss + 0.2)
    assert (plain.mirror, options.mirror) == (0.0, 1.0)


def test_the_highlight_moves_when_the_surface_tilts() -> None:
    options = api.RenderOptions.clean(gloss=0.5, mirror=1.0)
    brightest = []
    for tilt_deg in (0.0, 1.0):
        plate = replace(api.nominal_plate("deck", tilt_deg=(0.0, tilt_deg, 0.0)), holes=())
        _, right = api.clean_pair(api.nominal_head(), [plate], options)
        brightest.append(int(right[1000].argmax()))
    # 1° at 0.5 m is 9 mm on the surface, 62 px in the picture; vignetting pulls inwards.
    assert 40 < abs(brightest[1] - brightest[0]) < 65
