"""The search for an exposure, with a drawn plate as a camera would see it."""

import cv2
import numpy as np
import pytest

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.exposure_search import (
    Brightness,
    ExposureAim,
    ExposureSearch,
    ExposureVerdict,
    light_round_holes,
    of_all,
)

RADII_PX = (8.0, 16.0)
PLACES = ((60, 60), (180, 70), (110, 150))
AIM = ExposureAim(target_grey=180.0, least_s=20e-6, greatest_s=0.2)
STEPS = 16


def plate(grey: float, *, holes: bool = True) -> Array:
    """What a plate with dark holes of radius 12 px sends, for an exposure of 1 ms."""
    light = np.full((220, 260), grey)
    for centre in PLACES if holes else ():
        cv2.circle(light, centre, 12, 0.05 * grey, -1)
    return np.asarray(cv2.GaussianBlur(light, (0, 0), 0.8))


def image(light: Array, exposure_s: float) -> Image:
    """An image with a black level and noise, as a camera of 8 bit has them."""
    noise = np.random.default_rng(7).normal(0.0, 1.0, light.shape)
    grey = 4.0 + light * (exposure_s / 1e-3) + noise
    return np.clip(np.rint(grey), 0, 255).astype(np.uint8)


def searched(
    light: Array, exposure_s: float, aim: ExposureAim = AIM
) -> tuple[float, ExposureVerdict, int]:
    """The last exposure, what was said of it, and how many there were."""
    search = ExposureSearch(aim)
    for step in range(1, STEPS + 1):
        verdict = search.judge(exposure_s, light_round_holes(image(light, exposure_s), RADII_PX))
        if verdict.next_s is None:
            return exposure_s, verdict, step
        assert aim.least_s <= verdict.next_s <= aim.greatest_s
        exposure_s = verdict.next_s
    pytest.fail(f"no end after {STEPS} exposures, {exposure_s} s")


@pytest.mark.parametrize("begin_s", [20e-6, 0.5e-3, 5e-3, 0.2])
@pytest.mark.parametrize("grey", [4.0, 40.0, 600.0])
def test_the_plate_gets_the_grey_from_wherever_it_begins(begin_s: float, grey: float) -> None:
    exposure_s, verdict, _ = searched(plate(grey), begin_s)
    assert verdict.shortfall == ""
    assert exposure_s == pytest.approx(176.0 / grey * 1e-3, rel=0.06)
    seen = image(plate(grey), exposure_s)
    assert np.median(seen) == pytest.approx(180.0, abs=9.0)
    assert seen.max() < 254


def test_it_measures_round_the_holes_and_not_the_background() -> None:
    light = plate(40.0)
    light[:, 215:] = 400.0  # a lamp's reflection beside the part
    exposure_s, verdict, _ = searched(light, 1e-3)
    assert verdict.shortfall == ""
    assert exposure_s == pytest.approx(4.4e-3, rel=0.06)


def test_a_reflection_at_a_hole_ends_it_below_saturation() -> None:
    light = plate(40.0)
    for x, y in PLACES:
        light[y - 18 : y - 15, x - 8 : x + 8] = 120.0
    exposure_s, verdict, _ = searched(light, 1e-3)
    assert "it saturates from grey" in verdict.shortfall
    assert exposure_s < 251.0 / 120.0 * 1e-3
    assert exposure_s > 0.8 * 251.0 / 120.0 * 1e-3
    assert not light_round_holes(image(light, exposure_s), RADII_PX).saturated


@pytest.mark.parametrize(("grey", "why"), [(0.1, "its grey is"), (5e4, "saturates at the limit")])
def test_the_limits_are_kept(grey: float, why: str) -> None:
    _, verdict, _ = searched(plate(grey), 1e-3)
    assert why in verdict.shortfall


def test_a_plate_without_holes_is_not_enough() -> None:
    _, verdict, _ = searched(plate(40.0, holes=False), 1e-3)
    assert verdict.shortfall == "no holes of this size are seen"


def test_of_a_head_the_brighter_camera_decides() -> None:
    both = of_all([Brightness(120.0, 0.001, 4), Brightness(150.0, 0.02, 0)])
    assert both == Brightness(150.0, 0.02, 0)
    assert both.saturated


def test_holes_at_the_border_count_as_far_as_they_are_seen() -> None:
    seen = light_round_holes(image(plate(40.0)[50:, 50:], 4e-3), RADII_PX)
    assert seen.holes >= 2
    assert seen.grey == pytest.approx(164.0, abs=3.0)
