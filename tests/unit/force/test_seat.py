import numpy as np
import pytest

from cellctl.force.seat import SeatFinding, SeatLimits, judge_seat

GOOD = np.array([0.5, -0.3, 38.0, 2.0, 9.0, 0.1])
STIFFNESS = 7.5e5


def judge(wrench: np.ndarray, gap_m: float = 0.0) -> tuple[SeatFinding, ...]:
    travel_m = 0.010 - gap_m + wrench[2] / STIFFNESS
    return judge_seat(
        wrench,
        travel_m=travel_m,
        expected_m=0.010,
        stiffness_n_m=STIFFNESS,
        limits=SeatLimits(),
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
        GOOD, travel_m=0.004, expected_m=0.010, stiffness_n_m=STIFFNESS, limits=SeatLimits()
    )
    assert found.findings == (SeatFinding.HIGH,)
    assert found.false_seat
    assert not found.seated
    assert found.gap_m == pytest.approx(0.006 + 38.0 / STIFFNESS)


def test_too_deep_is_not_a_seat_either() -> None:
    assert judge(GOOD, gap_m=-2e-4) == (SeatFinding.DEEP,)


def test_resting_on_the_long_edge_within_tolerance_is_allowed() -> None:
    wrench = GOOD.copy()
    wrench[4] = 45.0 * 0.5
    assert judge(wrench) == ()
