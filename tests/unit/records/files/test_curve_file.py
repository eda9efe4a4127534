"""Recordings come back as they were written, and as far as they go when they were cut."""

import io
from datetime import UTC, datetime

import numpy as np
import pytest

from cellctl.errors.records.store import RecordingUnreadable
from cellctl.force.contact.curve import ForceCurve
from cellctl.records.files.curve_file import CurveWriter, encode_curve, read_recording

STARTED = datetime(2026, 11, 21, 12, 0, tzinfo=UTC)


def curve(samples: int = 5000) -> ForceCurve:
    time_s = 100.0 + np.arange(samples) / 1000
    travel_m = np.linspace(0, 0.010, samples)
    travel_m[0] = np.nan
    rng = np.random.default_rng(1)
    return ForceCurve(time_s, rng.normal(0, 10, (samples, 6)), travel_m)


def test_a_curve_comes_back() -> None:
    original = curve()
    recording = read_recording(encode_curve(original, STARTED, {"attempt": "1"}))
    assert recording.complete
    assert recording.facts == {"attempt": "1"}
    np.testing.assert_allclose(recording.curve.time_s, original.time_s - 100.0, atol=1e-6)
    np.testing.assert_allclose(recording.curve.wrench, original.wrench, atol=5e-5)
    np.testing.assert_allclose(recording.curve.travel_m, original.travel_m, atol=1e-8)


def test_it_is_small() -> None:
    assert len(encode_curve(curve(), STARTED, {})) < 75 * 5000


@pytest.mark.parametrize(
    "share", [0.6, *(pytest.param(one, marks=pytest.mark.figures) for one in (0.3, 0.95))]
)
def test_a_cut_recording_is_read_up_to_the_cut(share: float) -> None:
    original = curve(20_000)
    data = encode_curve(original, STARTED, {})
    recording = read_recording(data[: int(len(data) * share)])
    assert not recording.complete
    samples = len(recording.curve.time_s)
    assert 0.5 * share * 20_000 < samples < 20_000
    np.testing.assert_allclose(recording.curve.wrench, original.wrench[:samples], atol=5e-5)


@pytest.mark.parametrize(
    "data",
    [b"", b"\x89MCAP0\r\n", b"not a recording at all", bytes(range(99))],
    ids=["empty", "magic only", "text", "bytes"],
)
def test_what_is_no_recording_is_a_clear_fault(data: bytes) -> None:
    with pytest.raises(RecordingUnreadable):
        read_recording(data)


def test_an_empty_curve_is_no_fault() -> None:
    empty = ForceCurve(np.zeros(0), np.zeros((0, 6)), np.zeros(0))
    assert len(read_recording(encode_curve(empty, STARTED, {})).curve.time_s) == 0


def test_an_exception_still_ends_the_file() -> None:
    stream = io.BytesIO()

    def fail() -> None:
        with CurveWriter(stream, STARTED, {}) as writer:
            writer.add(0.0, 0.0, np.zeros(6))
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    assert read_recording(stream.getvalue()).complete


def test_flipped_bits_may_shorten_a_curve_but_never_change_it() -> None:
    original = curve(2000)
    data = bytearray(encode_curve(original, STARTED, {}))
    rng = np.random.default_rng(7)
    found = 0
    for position in rng.integers(8, len(data), 60):
        damaged = bytearray(data)
        damaged[position] ^= 1 << int(rng.integers(8))
        try:
            wrench = read_recording(bytes(damaged)).curve.wrench
        except RecordingUnreadable:
            found += 1
            continue
        found += len(wrench) < 2000
        np.testing.assert_allclose(wrench, original.wrench[: len(wrench)], atol=5e-5)
    assert found > 30
