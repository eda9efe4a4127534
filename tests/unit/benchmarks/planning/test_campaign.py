import numpy as np

from benchmarks.planning.campaign import try_cell
from benchmarks.planning.cells import GREATEST_SHIFT_M, random_cell


def test_random_cells_are_drawn_by_their_seed() -> None:
    first, again, other = random_cell(5), random_cell(5), random_cell(6)
    for name, shift_m in first.heads_shift_m.items():
        assert np.array_equal(shift_m, again.heads_shift_m[name])
        assert not np.array_equal(shift_m, other.heads_shift_m[name])
        assert np.abs(shift_m).max() <= GREATEST_SHIFT_M


def test_the_poses_over_the_station_go_with_the_frame() -> None:
    cell = random_cell(5)
    scene = cell.scene()
    arm = scene.arms["aux_1"]
    assert arm.config == scene.cell.robots["aux_1"]
    seen_m = (arm.cell_T_base * arm.base_T_flange(arm.taught_rad("measuring"))).translation
    assert np.allclose(seen_m, np.array([2.010, -0.390, 1.0526]) + cell.frame_shift_m, atol=1e-4)


def test_a_cell_is_refused_with_the_true_reason() -> None:
    refused = try_cell(1)
    assert refused.reason.startswith("F127")
    assert refused.points == 0
