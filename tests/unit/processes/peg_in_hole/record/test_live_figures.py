"""Depth, forces and moments of a contact are seen while it lasts."""

import numpy as np
import pytest

from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.cell.contact_motion.ticks import ContactTick, MotionKind
from cellctl.force.contact.streamed.ticks import Pace
from cellctl.processes.peg_in_hole.record.live_figures import LiveFigures
from cellctl.runtime.progress import Progress, ProgressBoard


def tick(time_s: float, depth_m: float, force_z_n: float, moment_x_n_m: float) -> ContactTick:
    sample = ContactSample(
        time_s,
        np.array([0.5e-3, -0.2e-3, depth_m]),
        np.radians([1.0, 0.0, -2.0]),
        np.array([1.0, 0.0, force_z_n]),
        np.array([moment_x_n_m, 0.0, 0.0]),
        0.1,
    )
    return ContactTick(sample, np.zeros(6), 0.01, 0.001, Pace.STEP, 0, 1, MotionKind.FEED)


def test_the_board_shows_the_way_to_the_seat_and_the_greatest_forces() -> None:
    board = ProgressBoard()
    figures = LiveFigures(board, 12e-3)
    figures.take(tick(1.0, 3e-3, -8.0, 0.1))
    figures.take(tick(1.25, 5e-3, -2.0, -0.3))
    shown = board.current
    assert shown.error_mm_deg == pytest.approx((0.5, -0.2, -7.0, 1.0, 0.0, -2.0))
    assert shown.force_peaks == pytest.approx((1.0, 0.0, 8.0, 0.3, 0.0, 0.0))


def test_it_tells_a_few_times_a_second_and_forgets_no_force_between() -> None:
    told: list[Progress] = []
    board = ProgressBoard()
    board.observers.append(told.append)
    figures = LiveFigures(board, 12e-3)
    for number in range(101):
        figures.take(tick(1.0 + number * 0.01, 1e-3, -20.0 if number == 7 else -8.0, 0.0))
    assert 4 <= len(told) <= 6
    assert told[-1].force_peaks[2] == pytest.approx(20.0)
