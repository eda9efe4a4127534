"""Covariances of poses in files: what no errors can have is refused."""

import numpy as np
import pytest

from cellctl.calibration.pose_record import covariance_from_written, covariance_to_written

VARIANCES = [4e-4, 4e-4, 1e-2, 1e-6, 1e-6, 9e-6]


def correlated(share: float) -> np.ndarray:
    """x and the turn about z go with each other by this share."""
    covariance = np.diag(VARIANCES)
    covariance[0, 5] = covariance[5, 0] = share * np.sqrt(VARIANCES[0] * VARIANCES[5])
    return covariance


@pytest.mark.parametrize("share", [0.0, 0.9, 1.0, 1.002])
def test_what_errors_can_have_is_taken_also_rounded(share: float) -> None:
    written = correlated(share)
    np.testing.assert_allclose(covariance_to_written(covariance_from_written(written)), written)


def test_a_direction_without_variance_is_no_mistake() -> None:
    covariance_from_written(np.diag([1e-4, 0.0, 0.0, 0.0, 0.0, 1e-6]))


@pytest.mark.parametrize("share", [1.5, -1.5])
def test_an_indefinite_one_is_refused(share: float) -> None:
    with pytest.raises(ValueError, match="semidefinite"):
        covariance_from_written(correlated(share))


def test_a_negative_variance_is_refused() -> None:
    with pytest.raises(ValueError, match="negative"):
        covariance_from_written(np.diag([1e-4, 1e-4, -1e-4, 1e-6, 1e-6, 1e-6]))


def test_one_that_is_not_symmetric_is_refused() -> None:
    covariance = correlated(0.5)
    covariance[5, 0] = 0.0
    with pytest.raises(ValueError, match="symmetric"):
        covariance_from_written(covariance)
