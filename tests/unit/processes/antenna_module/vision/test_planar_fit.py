"""x, y and yaw by drawn contacts: errors against stated covariances, and bent contacts."""

from pathlib import Path

import numpy as np
import pytest

from cellctl.processes.antenna_module.connector.connector import read_connector
from cellctl.processes.antenna_module.vision.matching import rotation
from cellctl.processes.antenna_module.vision.planar_fit import PlanarFit, fit_planar

PLUG = read_connector(Path("config/connectors/micro-d-15-pins.toml"))
NOISE_M = 2e-6
COVARIANCES = np.tile(np.eye(2) * NOISE_M**2, (15, 1, 1))
YAW, SHIFT = 0.3, np.array([1e-3, 2e-3])


def fitted(seed: int, *, true_position_m: float = 1e-9, scale: float = 1.0) -> PlanarFit:
    rng = np.random.default_rng(seed)
    points = scale * PLUG.positions_m @ rotation(YAW).T + SHIFT
    points += rng.normal(0.0, np.hypot(NOISE_M, true_position_m), points.shape)
    fit = fit_planar(PLUG.positions_m, points, COVARIANCES, true_position_m)
    assert fit is not None
    return fit


def test_errors_agree_with_the_stated_covariance() -> None:
    nees = []
    for seed in range(200):
        fit = fitted(seed)
        error = np.append(fit.shift_m - SHIFT, fit.yaw_rad - YAW)
        nees.append(error @ np.linalg.solve(fit.covariance, error))
    # The mean of 200 sums of three squares of unit normals, within four standard deviations.
    assert np.mean(nees) / 3.0 == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / 600.0))


def test_a_bent_contact_is_left_out_and_moves_nothing() -> None:
    points = PLUG.positions_m @ rotation(YAW).T + SHIFT
    points[0] += [0.1e-3, 0.05e-3]
    fit = fit_planar(PLUG.positions_m, points, COVARIANCES, 10e-6)
    assert fit is not None
    assert np.flatnonzero(~fit.used).tolist() == [0]
    assert np.abs(fit.shift_m - SHIFT).max() < 1e-9
    assert np.linalg.norm(fit.residuals_m[0]) == pytest.approx(np.hypot(0.1e-3, 0.05e-3), rel=1e-3)


def test_the_free_scale_says_how_wrong_the_plane_is() -> None:
    fit = fitted(1, scale=1.004)
    assert fit.scale == pytest.approx(1.004, abs=4.0 * fit.scale_sigma)
    assert fit.scale_sigma < 5e-4


def test_the_order_of_the_contacts_does_not_matter() -> None:
    points = PLUG.positions_m @ rotation(YAW).T + SHIFT
    points += np.random.default_rng(3).normal(0.0, 1e-5, points.shape)
    order = np.random.default_rng(4).permutation(15)
    one = fit_planar(PLUG.positions_m, points, COVARIANCES, 10e-6)
    other = fit_planar(PLUG.positions_m[order], points[order], COVARIANCES, 10e-6)
    assert one is not None
    assert other is not None
    assert np.abs(one.shift_m - other.shift_m).max() < 1e-12
    assert abs(one.yaw_rad - other.yaw_rad) < 1e-9


def test_two_contacts_are_too_few() -> None:
    points = PLUG.positions_m.copy()
    points[2:] = np.nan
    assert fit_planar(PLUG.positions_m, points, COVARIANCES, 10e-6) is None
