"""Ticks become a table that can be read again, and its peaks are known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.cell.contact_motion.ticks import ContactTick, MotionKind
from cellctl.force.contact.streamed.ticks import Pace
from cellctl.processes.peg_in_hole.record.tick_log import COLUMNS, LOOP_COLUMNS, TickLog, read_ticks


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
        at_bound = 2 if number > 16 else 0
        log.take(
            ContactTick(
                sample,
                np.zeros(6),
                0.008,
                0.001,
                Pace.STEP,
                0,
                1,
                MotionKind.FEED,
                at_bound,
                0.0125,
            )
        )
    return log


def test_what_was_felt_is_in_the_table() -> None:
    log = ticked(20)
    found = read_ticks(log.text())
    values = found.values
    assert set(values) == {*COLUMNS, *LOOP_COLUMNS}
    assert values["time_s"][-1] == pytest.approx(0.152)
    assert values["depth_mm"][-1] == pytest.approx(1.9)
    assert values["speed_mm_s"].tolist() == [12.5] * 20
    assert values["at_bound"].sum() == 6
    assert set(values["age_ms"]) == {8.0}
    assert set(values["force_age_ms"]) == {1.0}
    assert set(found.kinds) == {"feed"}
    np.testing.assert_allclose(log.peaks, [1.0, 2.0, 19.0, 0.1, 0.0, 0.0])


@pytest.mark.parametrize("kept", [10, 12])
def test_files_of_earlier_versions_are_read(kept: int) -> None:
    lines = [line.split(",") for line in ticked(5).text().splitlines()]
    older = [[*line[:10], *line[14:]][:kept] for line in lines]
    found = read_ticks("\n".join(",".join(line) for line in older))
    assert set(found.values) == set(COLUMNS)
    assert found.kinds == (("feed",) * 5 if kept == 12 else ())


def test_a_stream_without_a_tick_has_no_peaks() -> None:
    log = TickLog()
    assert np.isnan(log.peaks).all()
    with pytest.raises(ValueError, match="no table"):
        read_ticks(log.text())


@given(st.text())
def test_what_is_no_table_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"no table|rows|could not convert"):
        read_ticks(text)
