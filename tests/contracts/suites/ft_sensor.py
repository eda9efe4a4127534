"""What every force/torque sensor must do. The interface blocks, so these tests do too."""

import math
import select
import time
from abc import ABC, abstractmethod
from collections.abc import Callable

import pytest

from cellctl.clock import now_s
from cellctl.errors.link import LinkError
from cellctl.interfaces.ft_sensor import FtSensor, WrenchSample


class FtBench(ABC):
    """A sensor under test, not opened, that carries ``wrench`` (N, N·m)."""

    sensor: FtSensor
    wrench: tuple[float, ...]
    rate_hz: float

    @abstractmethod
    def silence(self) -> None:
        """Samples stop coming until the test ends; the link stands."""

    @abstractmethod
    def lose(self) -> None:
        """Some samples get lost on the way from now on."""

    @abstractmethod
    def spoil(self) -> None:
        """Some samples arrive damaged from now on."""

    @abstractmethod
    def saturate(self) -> None:
        """The sensor is overloaded from now on."""

    @abstractmethod
    def poison(self) -> None:
        """The electronics send numbers that are none from now on."""

    @abstractmethod
    def cut(self) -> None:
        """Break the link. The device comes back by itself."""


def values(sample: WrenchSample) -> tuple[float, ...]:
    return tuple(sample[3:9])


def collect(sensor: FtSensor, count: int, limit_s: float = 3.0) -> list[WrenchSample]:
    """Collect at least so many samples."""
    samples: list[WrenchSample] = []
    deadline_s = time.monotonic() + limit_s
    while len(samples) < count:
        assert time.monotonic() < deadline_s, f"only {len(samples)} samples in {limit_s} s"
        samples += sensor.read(0.1)
    return samples


def watch(
    sensor: FtSensor, seen: Callable[[list[WrenchSample]], bool], limit_s: float = 3.0
) -> list[WrenchSample]:
    """Read until a condition on all samples so far holds."""
    samples: list[WrenchSample] = []
    deadline_s = time.monotonic() + limit_s
    while not seen(samples):
        assert time.monotonic() < deadline_s, "not seen in time"
        samples += sensor.read(0.1)
    return samples


class FtSensorContract(ABC):
    """Written once; no clause may be left out by a driver."""

    @pytest.fixture
    @abstractmethod
    def bench(self) -> FtBench:
        """A fresh bench, torn down after the test."""

    @pytest.fixture
    def opened(self, bench: FtBench) -> FtBench:
        bench.sensor.open()
        return bench

    def test_close_in_any_state(self, bench: FtBench) -> None:
        bench.sensor.close()
        assert bench.sensor.fileno() == -1
        bench.sensor.open()
        assert bench.sensor.fileno() >= 0
        bench.sensor.close()
        bench.sensor.close()
        assert bench.sensor.fileno() == -1
        with pytest.raises(LinkError):
            bench.sensor.read(0.01)

    def test_open_again(self, bench: FtBench) -> None:
        for _ in range(2):
            with bench.sensor as sensor:
                collect(sensor, 10)

    def test_samples_are_right_fresh_and_in_order(self, opened: FtBench) -> None:
        samples = collect(opened.sensor, 100)
        for sample in samples:
            assert values(sample) == pytest.approx(opened.wrench, rel=1e-5, abs=1e-6)
            assert not sample.saturated
            assert sample.receive_time_s <= now_s()
            assert abs(sample.time_s - sample.receive_time_s) < 0.25
        assert now_s() - samples[-1].receive_time_s < 0.25
        times = [sample.time_s for sample in samples]
        assert times == sorted(times)
        span_s = times[-1] - times[20]
        assert span_s == pytest.approx((len(times) - 21) / opened.rate_hz, rel=0.25)
        assert opened.sensor.health().samples >= 100

    def test_the_rate_is_measured(self, opened: FtBench) -> None:
        def measured(_: list[WrenchSample]) -> bool:
            rate_hz = opened.sensor.health().rate_hz
            return rate_hz == pytest.approx(opened.rate_hz, rel=0.25)

        watch(opened.sensor, measured, limit_s=5.0)

    def test_descriptor_tells_of_samples(self, opened: FtBench) -> None:
        collect(opened.sensor, 1)
        readable, _, _ = select.select([opened.sensor], [], [], 1.0)
        assert readable

    def test_serial_number(self, opened: FtBench) -> None:
        assert opened.sensor.serial_number()

    def test_silence_ends_in_empty_reads_in_bounded_time(self, opened: FtBench) -> None:
        collect(opened.sensor, 10)
        opened.silence()
        start_s = time.monotonic()
        while opened.sensor.read(0.1):
            assert time.monotonic() - start_s < 1.0
        assert time.monotonic() - start_s < 1.5
        # The guard asks for stops between two readings: one that is late by as much as it likes
        # would keep it from them.
        start_s = time.monotonic()
        assert not opened.sensor.read(0.05)
        assert time.monotonic() - start_s < 0.25

    def test_lost_samples_are_counted(self, opened: FtBench) -> None:
        opened.lose()
        watch(opened.sensor, lambda _: opened.sensor.health().lost >= 3)

    def test_damaged_samples_are_counted_and_never_passed_on(self, opened: FtBench) -> None:
        opened.spoil()
        samples = watch(opened.sensor, lambda _: opened.sensor.health().checksum_errors >= 3)
        for sample in samples:
            assert values(sample) == pytest.approx(opened.wrench, rel=1e-5, abs=1e-6)

    def test_saturation_is_flagged(self, opened: FtBench) -> None:
        opened.saturate()
        watch(opened.sensor, lambda samples: any(sample.saturated for sample in samples))
        assert opened.sensor.health().saturated > 0

    def test_numbers_that_are_none_are_never_passed_on_as_good(self, opened: FtBench) -> None:
        collect(opened.sensor, 10)
        opened.poison()
        deadline_s = time.monotonic() + 0.3
        while time.monotonic() < deadline_s:
            for sample in opened.sensor.read(0.05):
                assert sample.saturated or all(math.isfinite(value) for value in values(sample))

    def test_reading_recovers_by_itself_from_a_broken_link(self, opened: FtBench) -> None:
        collect(opened.sensor, 10)
        opened.cut()
        watch(opened.sensor, lambda _: opened.sensor.health().reconnects > 0)
        assert values(collect(opened.sensor, 10)[-1]) == pytest.approx(opened.wrench, rel=1e-5)
