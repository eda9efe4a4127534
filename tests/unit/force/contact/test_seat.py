import numpy as np
import pytest

from cellctl.force.contact.seat import SeatFinding, judge_seat, seat_limits

GOOD = np.array([0.5, -0.3, 38.0, 2.0, 9.0, 0.1])
STIFFNESS = 7.5e5
SHIPPED = seat_limits(
    target_force_n=35.0, abort_force_n=45.0, max_lateral_n=25.0, half_size_m=(0.5, 0.25)
)


def judge(wrench: np.ndarray, gap_m: float = 0.0) -> tuple[SeatFinding, ...]:
    travel_m = 0.010 - gap_m + wrench[2] / STIFFNESS
    return judge_seat(
        wrench,
        travel_m=travel_m,
        expected_m=0.010,
        stiffness_n_m=STIFFNESS,
        limits=SHIPPED,
    ).findings


def test_a_good_seat_has_no_findings() -> None:
    assert judge(GOOD) == ()
    assert judge(GOOD, gap_m=9e-5) == ()


@pytest.mark.parametrize(
    ("index", "value", "finding"),
    [
        (2, 34.0, SeatFinding.FORCE_LOW),
        (2, 46.0, SeatFinding.FORCE_HIGH),
        (0, 21.0, SeatFinding.LATERAL),
        (3, -15.0, SeatFinding.MOMENT),
        (4, 25.0, SeatFinding.MOMENT),
        (5, 9.0, SeatFinding.MOMENT),
    ],
)
def test_each_component_alone_spoils_it(index: int, value: float, finding: SeatFinding) -> None:
    wrench = GOOD.copy()
    wrench[index] = value
    assert judge(wrench) == (finding,)


def test_force_without_depth_is_a_false_seat() -> None:
    found = judge_seat(
        GOOD, travel_m=0.004, expected_m=0.010, stiffness_n_m=STIFFNESS, limits=SHIPPED
    )
    assert found.findings == (SeatFinding.HIGH,)
    assert not found.seated
    assert found.gap_m == pytest.approx(0.006 + 38.0 / STIFFNESS)


def test_too_deep_is_not_a_seat_either() -> None:
    assert judge(GOOD, gap_m=-2e-4) == (SeatFinding.DEEP,)


def test_resting_on_the_long_edge_within_tolerance_is_allowed() -> None:
    wrench = GOOD.copy()
    wrench[4] = 45.0 * 0.5
    assert judge(wrench) == ()


def test_the_shipped_recipe_has_the_bounds_of_the_paper_s_deck() -> None:
    assert (SHIPPED.force_low_n, SHIPPED.force_high_n) == (35.0, 45.0)
    assert SHIPPED.lateral_n == 20.0
    assert SHIPPED.moment_n_m == (14.0, 24.0, 8.0)


def test_an_edge_of_another_deck_has_another_moment() -> None:
    small = seat_limits(
        target_force_n=60.0, abort_force_n=75.0, max_lateral_n=40.0, half_size_m=(0.2, 0.1)
    )
    assert small.lateral_n == 32.0
    assert small.moment_n_m[0] == pytest.approx(75.0 * 0.1 + 2.75)
    assert small.moment_n_m[1] == pytest.approx(75.0 * 0.2 + 1.5)


@pytest.mark.parametrize("index", range(6))
def test_what_is_not_a_number_is_never_seated(index: int) -> None:
    wrench = GOOD.copy()
    wrench[index] = np.nan
    assert judge(wrench)
    assert judge(GOOD, gap_m=float("nan"))
