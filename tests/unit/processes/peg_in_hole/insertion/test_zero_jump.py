import numpy as np
import pytest

from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.processes.peg_in_hole.insertion.zero_jump import ZeroJump, dropped_n, most_dropped_n
from tests.unit.processes.peg_in_hole.tasks import pin

TASK = pin(stiffness_n_m=1e5, force_sigma_n=0.1)
STEP_MM = 0.01
"""One newton of arm and contact."""


def felt(against: list[float], step_mm: float = STEP_MM) -> list[ContactSample]:
    return [
        ContactSample(
            0.008 * number,
            np.array([0.0, 0.0, (11.0 + number * step_mm) * 1e-3]),
            np.zeros(3),
            np.array([0.0, 0.0, -force]),
            np.zeros(3),
            0.1,
        )
        for number, force in enumerate(against)
    ]


RISE = [0.1 * number for number in range(10)] + [1.0 + number for number in range(14)]


def test_a_rise_at_the_seat_drops_by_nothing() -> None:
    assert dropped_n(felt(RISE), TASK) == 0.0


@pytest.mark.parametrize("jump_n", [5.5, 10.0, 14.0])
def test_a_zero_that_jumps_in_the_rise_is_told_within_three_ticks(jump_n: float) -> None:
    # Half of it in the tick of the jump: the sensor has a bandwidth.
    after = [RISE[-1] - 0.5 * jump_n, *(RISE[-1] - jump_n + 0.5 * one for one in range(1, 8))]
    watched = ZeroJump(TASK)
    told = [watched.take(sample) for sample in felt(RISE + after)]
    assert told.index(True) <= len(RISE) + 2
    # Less what the feed has added in the two ticks that prove it.
    assert watched.dropped_n == pytest.approx(jump_n - 1.0, abs=0.1)


def test_an_arm_that_goes_back_takes_the_force_with_it() -> None:
    back = [RISE[-1] - number for number in range(1, 11)]
    ways = [*felt(RISE), *felt(back, -STEP_MM)]
    # The way back begins where the way forward ended.
    end_m = ways[len(RISE) - 1].task_position_tip_m[2]
    for number, sample in enumerate(ways[len(RISE) :], 1):
        sample.task_position_tip_m[2] = end_m - number * STEP_MM * 1e-3
    assert dropped_n(ways, TASK) == pytest.approx(0.0, abs=1e-6)


def test_one_low_sample_is_a_spike_and_a_tick_without_a_new_force_counts_for_none() -> None:
    assert dropped_n(felt([*RISE, 2.0, 15.0, 16.0, 17.0]), TASK) == 0.0
    repeated = [force for force in RISE for _ in range(3)]
    assert dropped_n(felt(repeated, STEP_MM / 3), TASK) == 0.0


def test_a_peg_that_slides_down_a_chamfer_is_none() -> None:
    slid = [*felt(RISE), *felt([2.0] * 8)]
    for sample in slid:
        sample.task_position_tip_m[2] -= 11e-3
    assert float(slid[-1].task_position_tip_m[2]) < TASK.fit.entry_depth_m
    assert dropped_n(slid, TASK) == 0.0


def leaning_on_two_points(against: list[float], moment_n_m: float) -> list[ContactSample]:
    """The same forces 4 mm deep, with the moment of two points that rub in proportion to them."""
    samples = felt(against)
    for sample, force_n in zip(samples, against, strict=True):
        sample.task_position_tip_m[2] -= 7e-3
        sample.moment_n_m[1] = moment_n_m * force_n / max(against)
    return samples


@pytest.mark.parametrize(("moment_n_m", "least_n", "most_n"), [(0.07, 0.0, 1.5), (0.0, 4.5, 6.0)])
def test_friction_of_two_points_that_lets_go_is_no_jump(
    moment_n_m: float, least_n: float, most_n: float
) -> None:
    lets_go = [0.2, 1.0, 3.0, 5.0, 0.3, 0.2, 0.3]
    dropped = dropped_n(leaning_on_two_points(lets_go, moment_n_m), TASK)
    assert least_n <= dropped <= most_n


def test_the_limit_lies_above_friction_noise_and_what_a_stiff_arm_goes_back_unseen() -> None:
    assert most_dropped_n(TASK.cell) == 3.0
    assert most_dropped_n(pin(stiffness_n_m=1e5, force_sigma_n=0.5).cell) == 4.0
    assert most_dropped_n(pin(stiffness_n_m=1e6, force_sigma_n=0.5).cell) == 5.0
