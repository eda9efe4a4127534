"""The votes for one radius say nothing of another."""

import cv2
import numpy as np
import pytest

from cellctl.vision.holes.candidates import find_candidates


def test_a_disc_is_found_once_with_its_radius_and_its_support() -> None:
    image = np.full((160, 200), 180, np.uint8)
    cv2.circle(image, (90, 70), 10, 40, -1, cv2.LINE_AA)
    soft = np.asarray(cv2.GaussianBlur(image, (0, 0), 1.0), dtype=np.uint8)
    (found,) = find_candidates(soft, (7.0, 13.0))
    assert found.centre_px == pytest.approx([90.0, 70.0], abs=0.5)
    assert found.radius_px == pytest.approx(10.0, abs=0.3)
    # An edge that is as sharp as this one is wider than the count of a full circle allows for.
    assert 0.8 < found.support < 2.0
