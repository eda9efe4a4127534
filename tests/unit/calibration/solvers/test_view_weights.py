"""The covariance of unknowns from how views disagree about them."""

import numpy as np
import pytest

from cellctl.calibration.solvers.view_weights import weigh_views
from cellctl.errors.calibration import SolveFailed
from cellctl.geometry.pose import Array

SIZE = 3
FREE = np.zeros(SIZE)


def drawn(seed: int, views: int, common: float) -> tuple[Array, Array, Array, Array]:
    """A linear problem: information, pulls, error of the solution, inverse of the normal matrix.

    Each view has 50 observations of noise 1 and ``common``, an error that they share.
    """
    rng = np.random.default_rng(seed)
    design = rng.normal(size=(views, 50, SIZE)) + rng.normal(size=(views, 1, SIZE))
    noise = rng.normal(size=(views, 50)) + common * rng.normal(size=(views, 1))
    normal = np.einsum("vns,vnt->st", design, design)
    error = np.linalg.solve(normal, np.einsum("vns,vn->s", design, noise))
    residuals = noise - design @ error
    information = np.einsum("vns,vnt->vst", design, design)
    return information, np.einsum("vns,vn->vs", design, residuals), error, np.linalg.inv(normal)


def test_independent_errors_give_the_inverse_of_the_normal_matrix() -> None:
    ratios = []
    for seed in range(20):
        information, pulls, _, inverse = drawn(seed, 30, 0.0)
        covariance = weigh_views(FREE, information, pulls, "test").covariance
        ratios.append(np.diag(covariance) / np.diag(inverse))
    # Never below it, and above it by the chance of 30 views only.
    assert np.min(ratios) >= 1.0 - 1e-9
    assert np.mean(ratios) < 1.35


def test_errors_that_views_share_are_counted() -> None:
    normalised, naive = [], []
    for seed in range(200):
        information, pulls, error, inverse = drawn(seed, 20, 1.0)
        covariance = weigh_views(FREE, information, pulls, "test").covariance
        normalised.append(error @ np.linalg.solve(covariance, error) / SIZE)
        naive.append(error @ np.linalg.solve(inverse, error) / SIZE)
    assert np.mean(naive) > 10
    assert 0.7 < np.mean(normalised) < 1.4


def test_a_move_is_that_of_the_solution_without_the_view() -> None:
    information, pulls, _, _ = drawn(0, 12, 1.0)
    weighed = weigh_views(FREE, information, pulls, "test")
    rest, pull = information[1:].sum(axis=0), pulls[1:].sum(axis=0)
    moved = np.linalg.solve(rest, pull)
    expected = np.sqrt(moved @ np.linalg.solve(weighed.covariance, moved) / SIZE)
    assert weighed.shift_sigmas[0] == pytest.approx(expected, rel=1e-6)


def test_fewer_views_than_unknowns_still_give_a_covariance_of_full_rank() -> None:
    information, pulls, _, _ = drawn(1, 2, 1.0)
    covariance = weigh_views(FREE, information, pulls, "test").covariance
    assert np.linalg.eigvalsh(covariance).min() > 0


def test_units_do_not_count() -> None:
    information, pulls, _, _ = drawn(2, 15, 0.5)
    scale = np.array([1e-6, 1.0, 1e4])
    one = weigh_views(FREE, information, pulls, "test")
    other = weigh_views(FREE, information * np.outer(scale, scale), pulls * scale, "test")
    np.testing.assert_allclose(other.covariance * np.outer(scale, scale), one.covariance, rtol=1e-6)
    np.testing.assert_allclose(other.shift_sigmas, one.shift_sigmas, rtol=1e-6)


def test_an_unknown_that_nothing_determines() -> None:
    information, pulls, _, _ = drawn(3, 6, 0.0)
    information[:, 2], information[:, :, 2], pulls[:, 2] = 0.0, 0.0, 0.0
    with pytest.raises(SolveFailed, match="singular"):
        weigh_views(FREE, information, pulls, "test")
