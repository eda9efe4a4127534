"""What every device with digital inputs and outputs must do."""

import asyncio
from abc import ABC, abstractmethod

import pytest

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.errors.digital_io import OutputsDropped, SignalUnknown
from cellctl.errors.link import LinkError
from cellctl.interfaces.digital_io import DigitalIo

INPUTS = ("door", "tray")
OUTPUTS = ("lamp", "air", "clamp")


class DigitalIoBench(ABC):
    """A device under test, not connected, with the signals above, all off."""

    io: DigitalIo

    @abstractmethod
    def set_input(self, name: str, *, value: bool) -> None:
        """Switch a signal that the device reads."""

    @abstractmethod
    def driven(self) -> dict[str, bool]:
        """What the device really puts out."""

    @abstractmethod
    def writes(self) -> int:
        """How many outputs the device was told to set."""

    @abstractmethod
    def drop(self) -> None:
        """The device switches its outputs off by itself."""

    @abstractmethod
    def silence(self) -> None:
        """The device answers nothing until ``restore``; the link stands."""

    @abstractmethod
    def cut(self) -> None:
        """The link breaks. The device can be connected to again."""

    @abstractmethod
    def restore(self) -> None:
        """End ``silence``."""


async def until_off(bench: DigitalIoBench, limit_s: float = 5.0) -> None:
    """Wait until the device drives nothing."""
    async with asyncio.timeout(limit_s):
        while any(bench.driven().values()):  # noqa: ASYNC110  the device tells nobody
            await asyncio.sleep(0.01)


async def until_faulty(bench: DigitalIoBench, limit_s: float = 5.0) -> None:
    """Wait until the driver has seen the end of the link, which may take a call or two."""
    async with asyncio.timeout(limit_s):
        while True:
            try:
                await bench.io.read()
            except LinkError:
                return
            await asyncio.sleep(0.01)


class DigitalIoContract(ABC):
    """Written once; no clause may be left out by a driver."""

    @pytest.fixture
    @abstractmethod
    async def bench(self) -> DigitalIoBench:
        """A fresh bench, torn down after the test."""

    # --- connecting

    async def test_connecting_is_idempotent_and_switches_nothing(
        self, bench: DigitalIoBench
    ) -> None:
        await bench.io.connect()
        await bench.io.connect()
        assert bench.writes() == 0

    async def test_disconnect_in_any_state(self, bench: DigitalIoBench) -> None:
        await bench.io.disconnect()
        await bench.io.connect()
        await bench.io.disconnect()
        await bench.io.disconnect()
        with pytest.raises(LinkError):
            await bench.io.read()
        with pytest.raises(LinkError):
            await bench.io.write({"lamp": True})

    async def test_letting_go_writes_nothing(self, bench: DigitalIoBench) -> None:
        await bench.io.let_go()
        await bench.io.connect()
        await bench.io.write({"lamp": True, "clamp": True})
        before = bench.writes()
        await bench.io.let_go()
        await bench.io.let_go()
        assert bench.writes() == before
        with pytest.raises(LinkError):
            await bench.io.read()
        await bench.io.connect()
        await bench.io.read()

    async def test_connect_again(self, bench: DigitalIoBench) -> None:
        for _ in range(2):
            async with bench.io as io:
                await io.write({"lamp": True})
                assert bench.driven()["lamp"]

    # --- values

    async def test_names(self, bench: DigitalIoBench) -> None:
        assert set(bench.io.input_names) == set(INPUTS)
        assert set(bench.io.output_names) == set(OUTPUTS)
        async with bench.io as io:
            state = await io.read()
        assert set(state.inputs) == set(INPUTS)
        assert set(state.outputs) == set(OUTPUTS)

    async def test_each_input_is_read_where_it_is(self, bench: DigitalIoBench) -> None:
        async with bench.io as io:
            for name in INPUTS:
                bench.set_input(name, value=True)
                before_s = now_s()
                state = await io.read()
                assert before_s <= state.time_s <= now_s()
                assert [n for n, value in state.inputs.items() if value] == [name]
                bench.set_input(name, value=False)

    async def test_each_output_is_set_and_read_back(self, bench: DigitalIoBench) -> None:
        async with bench.io as io:
            for name in OUTPUTS:
                for value in (True, True, False, False):
                    await io.write({name: value})
                    expected = {other: other == name and value for other in OUTPUTS}
                    assert bench.driven() == expected
                    assert dict((await io.read()).outputs) == expected

    async def test_outputs_that_are_not_named_stay(self, bench: DigitalIoBench) -> None:
        async with bench.io as io:
            await io.write({"lamp": True, "clamp": True})
            await io.write({"clamp": False})
            assert bench.driven() == {"lamp": True, "air": False, "clamp": False}
            await io.write({})
            assert bench.driven() == {"lamp": True, "air": False, "clamp": False}

    async def test_unknown_outputs_are_refused_and_nothing_is_written(
        self, bench: DigitalIoBench
    ) -> None:
        async with bench.io as io:
            for outputs in ({"lamp": True, "siren": True}, {"door": True}):
                with pytest.raises(SignalUnknown):
                    await io.write(outputs)
            assert bench.writes() == 0
            await io.write({"lamp": True})  # the link is sound

    async def test_callers_do_not_disturb_each_other(self, bench: DigitalIoBench) -> None:
        async with bench.io as io:
            await asyncio.gather(*(io.write({name: True}) for name in OUTPUTS))
            states = await asyncio.gather(*(io.read() for _ in range(4)))
        assert all(all(state.outputs.values()) for state in states)

    # --- safe state

    async def test_disconnecting_switches_everything_off(self, bench: DigitalIoBench) -> None:
        async with bench.io as io:
            await io.write(dict.fromkeys(OUTPUTS, True))
        assert not any(bench.driven().values())

    async def test_outputs_stay_while_nobody_calls(self, bench: DigitalIoBench) -> None:
        async with bench.io as io:
            await io.write({"clamp": True})
            await asyncio.sleep(1.2)  # longer than any bench's watchdog: the driver keeps it awake
            assert bench.driven()["clamp"]
            await io.read()

    async def test_a_lost_link_switches_everything_off_for_good(
        self, bench: DigitalIoBench
    ) -> None:
        await bench.io.connect()
        await bench.io.write({"clamp": True})
        bench.cut()
        await until_faulty(bench)
        await until_off(bench)
        with pytest.raises(LinkError):
            await bench.io.write({"lamp": True})
        await bench.io.connect()
        assert not any(bench.driven().values())
        await bench.io.write({"clamp": True})
        assert bench.driven()["clamp"]

    async def test_silence_is_a_fault_in_bounded_time(self, bench: DigitalIoBench) -> None:
        await bench.io.connect()
        bench.silence()
        async with asyncio.timeout(5.0):
            with pytest.raises(LinkError):
                await bench.io.read()
            with pytest.raises(LinkError):
                await bench.io.write({"lamp": True})
        bench.restore()
        await bench.io.connect()
        assert not any(bench.driven().values())
        await bench.io.read()

    async def test_dropped_outputs_are_a_fault_and_stay_off(self, bench: DigitalIoBench) -> None:
        await bench.io.connect()
        await bench.io.write({"clamp": True})
        bench.drop()
        with pytest.raises(OutputsDropped):
            await bench.io.write({"lamp": True})
        assert not any(bench.driven().values())
        with pytest.raises(CellError):
            await bench.io.read()
        await bench.io.connect()
        assert not any(bench.driven().values())
        await bench.io.write({"lamp": True})
        assert bench.driven() == {"lamp": True, "air": False, "clamp": False}

    async def test_cancelling_leaves_a_sound_link(self, bench: DigitalIoBench) -> None:
        async with bench.io as io:
            for _ in range(5):
                write = asyncio.create_task(io.write(dict.fromkeys(OUTPUTS, True)))
                await asyncio.sleep(0)
                write.cancel()
                await asyncio.gather(write, return_exceptions=True)
            state = await io.read()
            assert dict(state.outputs) == bench.driven()
