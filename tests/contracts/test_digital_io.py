"""The contract of digital I/O: in memory, and every driver against its wire fake."""

from collections.abc import AsyncIterator

import pytest

from cellctl.clock import now_s
from cellctl.errors.link import LinkLost
from cellctl.interfaces.digital_io import DigitalIo
from drivers.io.modbus_coupler.config import ModbusCouplerConfig
from drivers.io.modbus_coupler.driver import ModbusCouplerIo
from fakes.wire.couplers.coupler import CouplerServer
from tests.contracts.inprocess.digital_io import InProcessIo
from tests.contracts.suites.digital_io import INPUTS, OUTPUTS, DigitalIoBench, DigitalIoContract
from tests.rigs.wire.proxy import ChaosProxy

INPUT_ADDRESSES = {"door": 3, "tray": 12}
OUTPUT_ADDRESSES = {"lamp": 0, "air": 1, "clamp": 9}


class InProcessBench(DigitalIoBench):
    def __init__(self) -> None:
        self.memory = InProcessIo("memory", INPUTS, OUTPUTS)
        self.io: DigitalIo = self.memory

    def set_input(self, name: str, *, value: bool) -> None:
        self.memory.inputs[name] = value

    def driven(self) -> dict[str, bool]:
        return dict(self.memory.driven)

    def writes(self) -> int:
        return self.memory.writes

    def drop(self) -> None:
        self.memory.drop()

    def silence(self) -> None:
        self.memory.silent = True

    def cut(self) -> None:
        self.memory.end(LinkLost("cable"))

    def restore(self) -> None:
        self.memory.silent = False


class ModbusBench(DigitalIoBench):
    def __init__(self) -> None:
        self.values = {address: address == 5 for address in range(16)}
        """An input beside ours is on, to be told from them."""
        self.coupler = CouplerServer(
            now_s,
            inputs=lambda time_s: self.values,
            output_addresses=range(16),
            watchdog_ms=900,
        )

    async def start(self) -> None:
        self.wire = ChaosProxy(await self.coupler.start())
        await self.wire.__aenter__()
        settings = ModbusCouplerConfig(
            host="127.0.0.1",
            port=self.wire.port,
            reply_timeout_s=0.6,
            inputs=INPUT_ADDRESSES,
            outputs=OUTPUT_ADDRESSES,
        )
        self.io: DigitalIo = ModbusCouplerIo("io", settings)

    async def stop(self) -> None:
        await self.io.disconnect()
        await self.wire.__aexit__(None, None, None)
        await self.coupler.stop()

    def set_input(self, name: str, *, value: bool) -> None:
        self.values[INPUT_ADDRESSES[name]] = value

    def driven(self) -> dict[str, bool]:
        outputs = self.coupler.outputs
        return {name: outputs[address] for name, address in OUTPUT_ADDRESSES.items()}

    def writes(self) -> int:
        return self.coupler.writes

    def drop(self) -> None:
        self.coupler.drop_outputs()

    def silence(self) -> None:
        self.coupler.faults.inject("silent")

    def cut(self) -> None:
        self.wire.reset()

    def restore(self) -> None:
        self.coupler.faults.clear()


class TestInProcessIo(DigitalIoContract):
    @pytest.fixture
    def bench(self) -> DigitalIoBench:
        return InProcessBench()


class TestModbusCouplerIo(DigitalIoContract):
    driver = ModbusCouplerIo

    @pytest.fixture
    async def bench(self) -> AsyncIterator[DigitalIoBench]:
        bench = ModbusBench()
        await bench.start()
        yield bench
        await bench.stop()
