"""Discs that are seen askew, and bright areas that are none."""

import cv2
import numpy as np
import pytest

from cellctl.vision.holes.candidates import find_candidates
from cellctl.vision.holes.discs import bright_discs

RADII = (55.0, 90.0)


def image_with(axes: tuple[int, int], at: tuple[int, int] = (200, 150)) -> np.ndarray:
    image = np.full((320, 400), 30, np.uint8)
    cv2.ellipse(image, at, axes, 25.0, 0, 360, 190, -1, cv2.LINE_AA)
    soft = np.asarray(cv2.GaussianBlur(image, (0, 0), 1.0), dtype=float)
    noise = np.random.default_rng(1).normal(0, 2, soft.shape)
    return np.clip(soft + noise, 0, 255).astype(np.uint8)


@pytest.mark.parametrize("short", [52, 60, 70])
def test_a_disc_that_is_seen_askew_is_found_with_the_length_of_its_ellipse(short: int) -> None:
    image = image_with((72, short))
    (found,) = bright_discs(image, RADII)
    assert found.centre_px == pytest.approx([200.0, 150.0], abs=0.1)
    assert found.radius_px == pytest.approx(72.0, abs=0.8)


def test_votes_alone_put_a_disc_that_is_seen_askew_elsewhere() -> None:
    voted = find_candidates(image_with((72, 52)), RADII, bright=True)
    assert all(np.linalg.norm(one.centre_px - [200.0, 150.0]) > 10.0 for one in voted)


def test_a_disc_with_a_scratch_is_left_to_the_votes() -> None:
    image = image_with((70, 70))
    cv2.line(image, (100, 160), (300, 170), 30, 9)
    (found,) = bright_discs(image, RADII)
    assert found.centre_px == pytest.approx([200.0, 150.0], abs=8.0)
    assert found.support != 1.0, "that of an area"


@pytest.mark.parametrize(
    ("axes", "at"), [((72, 40), (200, 150)), ((110, 100), (200, 150)), ((72, 70), (50, 150))]
)
def test_too_narrow_too_large_or_cut_by_the_edge_is_no_disc(
    axes: tuple[int, int], at: tuple[int, int]
) -> None:
    assert [one for one in bright_discs(image_with(axes, at), RADII) if one.support == 1.0] == []


def test_a_bright_square_is_no_disc() -> None:
    image = np.full((320, 400), 30, np.uint8)
    cv2.rectangle(image, (140, 90), (260, 210), 190, -1)
    assert [one for one in bright_discs(image, RADII) if one.support == 1.0] == []


def test_an_image_without_anything_has_no_disc() -> None:
    assert bright_discs(np.full((320, 400), 30, np.uint8), RADII) == []
