"""Ticks become a table that can be read again, and its peaks are known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.cell.contact_motion.ticks import ContactTick, MotionKind
from cellctl.force.contact.streamed.ticks import Pace
from cellctl.processes.peg_in_hole.record.tick_log import COLUMNS, TickLog, read_ticks


def ticked(count: int) -> TickLog:
    log = TickLog()
    for number in range(count):
        sample = ContactSample(
            10.0 + number * 0.008,
            np.array([1e-3, -2e-3, number * 1e-4]),
            np.zeros(3),
            np.array([1.0, -2.0, -number]),
            np.array([0.1, 0.0, 0.0]),
            0.1,
        )
        log.take(ContactTick(sample, np.zeros(6), 0.008, 0.001, Pace.STEP, 0, 1, MotionKind.FEED))
    return log


def test_what_was_felt_is_in_the_table() -> None:
    log = ticked(20)
    found = read_ticks(log.text())
    assert set(found) == set(COLUMNS)
    assert found["time_s"][-1] == pytest.approx(0.152)
    assert found["depth_mm"][-1] == pytest.approx(1.9)
    np.testing.assert_allclose(log.peaks, [1.0, 2.0, 19.0, 0.1, 0.0, 0.0])


def test_a_stream_without_a_tick_has_no_peaks() -> None:
    log = TickLog()
    assert np.isnan(log.peaks).all()
    with pytest.raises(ValueError, match="no table"):
        read_ticks(log.text())


@given(st.text())
def test_what_is_no_table_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"no table|rows|could not convert"):
        read_ticks(text)
