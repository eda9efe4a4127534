"""All rims of an image share one scale of uncertainty, which their residuals tell."""

from dataclasses import replace

import numpy as np
import pytest

from cellctl.vision.camera.ellipse import Ellipse
from cellctl.vision.rim.image_scale import image_scale, with_image_scales
from cellctl.vision.rim.spread import ImageSpread
from cellctl.vision.rim.stereo_fit import Rim, RimPair
from tests.unit.vision.rim.test_shown_spread import fitted_bore

COVARIANCE = np.array([[4e-4, 1e-4], [1e-4, 2e-4]])
ELLIPSE = Ellipse(np.zeros(2), (20.0, 19.0), 0.0)
RIM = Rim(np.zeros(2), COVARIANCE, ELLIPSE, 1.0, 1.0, misfit=1.0)
FIT = fitted_bore(ImageSpread(), ImageSpread())


def pair(left: float, right: float) -> RimPair:
    joint = np.zeros((4, 4))
    joint[:2, :2] = joint[2:, 2:] = COVARIANCE
    joint[0, 2] = joint[2, 0] = 5e-5
    rims = replace(RIM, misfit=left), replace(RIM, misfit=right)
    return RimPair(*rims, joint, (FIT, FIT), one_edge=True)


def test_good_images_change_nothing() -> None:
    given = [pair(0.4, 1.1), pair(1.3, 0.8), pair(2.2, 1.5)]
    for before, after in zip(given, with_image_scales(given), strict=True):
        np.testing.assert_array_equal(after.covariance_px2, before.covariance_px2)


def test_a_doubtful_image_widens_all_its_rims_and_no_other_image() -> None:
    given = [pair(4.0, 1.0), pair(1.0, 0.5), pair(3.0, 1.5)]
    assert image_scale([one.left for one in given]) == pytest.approx(3.0)
    _check_left_only(given)


def test_one_doubtful_rim_is_not_the_image() -> None:
    given = [pair(11.0, 1.0), pair(1.0, 0.5), pair(1.5, 9.0)]
    assert image_scale([one.left for one in given]) == 1.0
    assert image_scale([one.right for one in given]) == 1.0


def _check_left_only(given: list[RimPair]) -> None:
    for before, after in zip(given, with_image_scales(given), strict=True):
        np.testing.assert_allclose(after.left.covariance_px2, 3.0 * COVARIANCE)
        np.testing.assert_allclose(after.right.covariance_px2, COVARIANCE)
        np.testing.assert_allclose(after.covariance_px2[:2, :2], 3.0 * COVARIANCE)
        np.testing.assert_allclose(after.covariance_px2[2:, 2:], COVARIANCE)
        # Both points hang together as much as before.
        ratio = after.covariance_px2[0, 2] / before.covariance_px2[0, 2]
        assert ratio == pytest.approx(np.sqrt(3.0))
