"""The contract of the force sensor: in memory, and the SRI driver against the fake box."""

import math
from collections.abc import Iterator

import pytest

from cellctl.interfaces.ft_sensor import FtSensor
from drivers.ftsensor.sri.config import SriConfig
from drivers.ftsensor.sri.driver import SriSensor
from fakes.wire.sri.box import SriBox
from tests.contracts.inprocess.ft_sensor import InProcessSensor
from tests.contracts.loop_thread import LoopThread
from tests.contracts.suites.ft_sensor import FtBench, FtSensorContract

WRENCH = (10.0, -20.0, -1962.0, 1.5, -2.5, 0.25)


class InProcessBench(FtBench):
    wrench = WRENCH
    rate_hz = 500.0

    def __init__(self) -> None:
        self.memory = InProcessSensor(WRENCH, self.rate_hz)
        self.sensor: FtSensor = self.memory

    def silence(self) -> None:
        self.memory.silent = True

    def lose(self) -> None:
        self.memory.losing = True

    def spoil(self) -> None:
        self.memory.spoiling = True

    def saturate(self) -> None:
        self.memory.overloaded = True

    def poison(self) -> None:
        self.memory.wrench = (math.nan,) * 6

    def cut(self) -> None:
        self.memory.broken = True


class SriBench(FtBench):
    wrench = WRENCH
    rate_hz = 500.0

    def __init__(self, thread: LoopThread) -> None:
        self._thread = thread
        self.box = SriBox(lambda time_s: WRENCH)
        port = thread.run(self.box.start_tcp())
        config = SriConfig(
            transport="tcp",
            host="127.0.0.1",
            port=port,
            rate_hz=self.rate_hz,
            range=(5000.0, 5000.0, 5000.0, 500.0, 500.0, 500.0),
            reconnect_s=0.1,
        )
        self.sensor: FtSensor = SriSensor(config)

    def silence(self) -> None:
        self.box.faults.inject("silent")

    def lose(self) -> None:
        self.box.faults.inject("skip_every", 7)

    def spoil(self) -> None:
        self.box.faults.inject("corrupt_every", 7)

    def saturate(self) -> None:
        self.box.faults.inject("saturated")

    def poison(self) -> None:
        self.box.faults.inject("nan")

    def cut(self) -> None:
        self._thread.call(self.box.drop_clients)


class TestInProcessSensor(FtSensorContract):
    @pytest.fixture
    def bench(self) -> Iterator[FtBench]:
        bench = InProcessBench()
        yield bench
        bench.sensor.close()


class TestSriSensor(FtSensorContract):
    driver = SriSensor

    @pytest.fixture
    def bench(self) -> Iterator[FtBench]:
        with LoopThread() as thread:
            bench = SriBench(thread)
            yield bench
            bench.sensor.close()
            thread.run(bench.box.stop())
