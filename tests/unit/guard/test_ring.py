"""The shared ring: order, wrap, overrun, and a reader beside a writer in another process."""

import multiprocessing
import os
from collections.abc import Iterator

import numpy as np
import pytest

from cellctl.guard import ring
from cellctl.guard.ring import GuardStatus, RingWriter
from cellctl.guard.ring_reader import RingReader
from cellctl.interfaces.ft_sensor import FtHealth, WrenchSample

SLOTS = 64


def publish(writer: RingWriter, number: int) -> None:
    value = float(number)
    sample = WrenchSample(value + 0.5, value, number, *(value,) * 6, saturated=False)
    writer.publish(sample, (-value,) * 6, 0.25)


@pytest.fixture
def ends() -> Iterator[tuple[RingWriter, RingReader]]:
    descriptor = ring.create(SLOTS)
    writer, reader = RingWriter(descriptor), RingReader(descriptor)
    os.close(descriptor)
    yield writer, reader
    writer.close()
    reader.close()


def test_empty(ends: tuple[RingWriter, RingReader]) -> None:
    _, reader = ends
    assert reader.latest() is None
    curve = reader.since(0.0)
    assert (len(curve.time_s), curve.overrun) == (0, False)
    assert curve.wrench.shape == (0, 6)


def test_latest_and_since(ends: tuple[RingWriter, RingReader]) -> None:
    writer, reader = ends
    for number in range(10):
        publish(writer, number)
    newest = reader.latest()
    assert newest is not None
    assert (newest.number, newest.time_s, newest.receive_time_s) == (9, 9.0, 9.5)
    assert newest.wrench.tolist() == [-9.0] * 6
    assert newest.raw.tolist() == [9.0] * 6
    curve = reader.since(5.0)
    assert curve.time_s.tolist() == [6.0, 7.0, 8.0, 9.0]
    assert not curve.overrun
    assert len(reader.since(-1.0).time_s) == 10
    assert len(reader.since(9.0).time_s) == 0


@pytest.mark.parametrize("count", [SLOTS - 1, SLOTS, SLOTS + 1, 5 * SLOTS + 7])
def test_around_the_wrap(ends: tuple[RingWriter, RingReader], count: int) -> None:
    writer, reader = ends
    for number in range(count):
        publish(writer, number)
    curve = reader.since(count - 11.0)
    assert curve.time_s.tolist() == [float(n) for n in range(count - 10, count)]
    assert not curve.overrun
    everything = reader.since(-1.0)
    assert everything.time_s[-1] == count - 1
    assert np.all(np.diff(everything.time_s) == 1.0)
    assert everything.overrun == (count > SLOTS - 1)
    assert np.array_equal(everything.wrench[:, 0], -everything.time_s)


def test_what_is_handed_out_is_a_copy(ends: tuple[RingWriter, RingReader]) -> None:
    writer, reader = ends
    publish(writer, 0)
    newest, curve = reader.latest(), reader.since(-1.0)
    for number in range(1, SLOTS + 5):
        publish(writer, number)
    assert newest is not None
    assert newest.raw.tolist() == [0.0] * 6
    assert curve.raw.tolist() == [[0.0] * 6]


def test_status(ends: tuple[RingWriter, RingReader]) -> None:
    writer, reader = ends
    assert reader.status() == GuardStatus()
    status = GuardStatus(
        time_s=1.5,
        armed=1,
        latched=0,
        channel_up=1,
        sensor_open=1,
        late_wakeups=3,
        resident_peak_bytes=4096,
        sample_time_s=1.4,
        flange_time_s=1.3,
        sensor=FtHealth(1, 2, 3, 4, 5, 6, 7, 8, 999.5),
        peak_raw=(1.0, 2.0, 3.0, 4.0, 5.0, 6.0),
        peak_filtered=(6.0, 5.0, 4.0, 3.0, 2.0, 1.0),
    )
    writer.publish_status(status)
    assert reader.status() == status


def test_a_status_left_half_written_is_not_believed(ends: tuple[RingWriter, RingReader]) -> None:
    writer, reader = ends
    writer.publish_status(GuardStatus(time_s=1.0))
    reader._words.flags.writeable = True
    reader._words[ring.STATUS_NUMBER] += 1
    assert reader.status() is None


@pytest.mark.parametrize("slots", [0, 1, 100])
def test_odd_sizes_are_refused(slots: int) -> None:
    with pytest.raises(ValueError, match="power of two"):
        ring.create(slots)


def _write_on(descriptor: int, count: int) -> None:
    writer = RingWriter(descriptor)
    for number in range(count):
        publish(writer, number)


def test_a_reader_beside_a_racing_writer_never_sees_a_torn_sample() -> None:
    """The ring is so small that the writer laps the reader all the time."""
    descriptor = ring.create(SLOTS)
    reader = RingReader(descriptor)
    count = 150_000
    process = multiprocessing.get_context("fork").Process(
        target=_write_on, args=(descriptor, count)
    )
    process.start()
    reads = overruns = 0
    last = -1.0
    while last < count - 1:
        assert process.is_alive() or reader.latest() is not None
        curve = reader.since(last)
        reads += len(curve.time_s)
        overruns += curve.overrun
        for column in range(6):
            assert np.array_equal(curve.wrench[:, column], -curve.time_s)
            assert np.array_equal(curve.raw[:, column], curve.time_s)
        assert np.all(np.diff(curve.time_s) == 1.0)
        if len(curve.time_s):
            last = float(curve.time_s[-1])
    process.join(5)
    assert process.exitcode == 0
    assert reads > 0
    assert reads == count or overruns > 0
    reader.close()
    os.close(descriptor)
