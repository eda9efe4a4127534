import numpy as np

from cellctl.processes.peg_in_hole.search.hole_map import HoleMap


def test_prior_holds_99_percent_within_the_uncertainty() -> None:
    belief = HoleMap(3e-3, 0.3e-3)
    inside = np.hypot(*np.moveaxis(belief.points_m, -1, 0)) <= 3e-3
    # The prior is cut at 1.15 of the uncertainty, which leaves 99.76 % of it.
    assert abs(belief.weights[inside].sum() - 0.99 / 0.9976) < 2e-3


def test_ruling_out_moves_the_belief_away_and_keeps_some() -> None:
    belief = HoleMap(3e-3, 0.5e-3)
    before = belief.weights.copy()
    belief.rule_out(np.array([[1e-3, 0.0]]))
    assert belief.mean_m()[0] < -1e-5
    near = np.hypot(belief.points_m[..., 0] - 1e-3, belief.points_m[..., 1]) < 0.4e-3
    assert 0 < belief.weights[near].sum() < 0.03 * before[near].sum()
    assert abs(belief.weights.sum() - 1) < 1e-12


def test_exhausted_once_nearly_all_of_it_was_visited() -> None:
    belief = HoleMap(2e-3, 0.5e-3)
    belief.rule_out(belief.points_m.reshape(-1, 2)[: belief.points_m.shape[1] * 20])
    assert not belief.exhausted
    belief.rule_out(belief.points_m.reshape(-1, 2))
    assert belief.exhausted


def test_a_retry_begins_with_what_is_left() -> None:
    belief = HoleMap(2e-3, 0.5e-3)
    belief.rule_out(belief.points_m[belief.points_m[..., 0] > -0.5e-3])
    left = belief.weights.copy()
    assert belief.likeliest_m()[0] < -0.9e-3
    belief.begin_again()
    np.testing.assert_array_equal(belief.weights, left)
    assert not belief.exhausted
    belief.rule_out(belief.points_m.reshape(-1, 2))
    assert belief.exhausted


def test_points_outside_of_the_map_say_nothing() -> None:
    belief = HoleMap(2e-3, 0.5e-3)
    before = belief.weights.copy()
    belief.rule_out(np.array([[1.0, 1.0]]))
    np.testing.assert_array_equal(belief.weights, before)
