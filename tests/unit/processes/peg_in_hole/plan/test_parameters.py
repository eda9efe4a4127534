"""What a search is tuned by, from the figures of its task."""

import pytest

from cellctl.processes.peg_in_hole.plan.parameters import search_parameters
from cellctl.processes.peg_in_hole.plan.task import SearchTask
from tests.unit.processes.peg_in_hole.tasks import pin, plug

_SOFT_N_M, _STIFF_N_M = 1e5, 9e5


@pytest.mark.parametrize(
    ("task", "press_n"),
    [
        (pin(0.01, stiffness_n_m=_SOFT_N_M), 3.2),
        (pin(0.02, stiffness_n_m=_SOFT_N_M), 5.0),
        (pin(0.05, stiffness_n_m=_SOFT_N_M), 8.0),
        (pin(0.01, stiffness_n_m=_STIFF_N_M), 8.0),
        (pin(0.01, chamfer_mm=0.5, stiffness_n_m=_SOFT_N_M), 8.0),
        (plug(stiffness_n_m=_SOFT_N_M), 8.0),
    ],
)
def test_a_spiral_presses_less_where_friction_bends_the_arm_by_much_of_the_catch_radius(
    task: SearchTask, press_n: float
) -> None:
    assert search_parameters(task).spiral_press.value == pytest.approx(press_n)
