"""Digital I/O and gripper against the fake coupler: every fault of the device and of the wire."""

import asyncio
from collections.abc import AsyncIterator
from dataclasses import dataclass

import pytest
from pydantic import ValidationError

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.errors.digital_io import OutputsDropped, WatchdogUnsuitable
from cellctl.errors.link import DeviceFault, LinkError, LinkLost, ProtocolViolation, ReplyTimeout
from drivers.gripper.pneumatic.config import PneumaticGripperConfig
from drivers.io.modbus_coupler.config import ModbusCouplerConfig
from drivers.io.modbus_coupler.driver import ModbusCouplerIo
from fakes.wire.couplers.coupler import CouplerServer
from tests.rigs.wire.proxy import ChaosProxy
from tests.wire.modbus.gripper_rig import GripperRig, gripper_rig

WATCHDOG_MS = 300


@dataclass
class IoRig:
    io: ModbusCouplerIo
    coupler: CouplerServer
    wire: ChaosProxy


@pytest.fixture
async def rig() -> AsyncIterator[IoRig]:
    coupler = CouplerServer(
        now_s,
        inputs=lambda time_s: dict.fromkeys(range(8), False),
        output_addresses=range(8),
        watchdog_ms=WATCHDOG_MS,
    )
    async with ChaosProxy(await coupler.start()) as wire:
        settings = ModbusCouplerConfig(
            host="127.0.0.1",
            port=wire.port,
            reply_timeout_s=0.25,
            inputs={"door": 0},
            outputs={"lamp": 0, "clamp": 4},
        )
        io = ModbusCouplerIo("io", settings)
        await io.connect()
        yield IoRig(io, coupler, wire)
        await io.disconnect()
    await coupler.stop()


async def good(rig: IoRig) -> None:
    """The device works after a new connection, with its outputs off or as they are."""
    async with asyncio.timeout(5.0):
        while True:
            try:
                await rig.io.connect()
                await rig.io.write({"lamp": True})
                assert rig.coupler.outputs[0]
            except LinkLost:
                continue
            return


@pytest.mark.parametrize(
    ("fault", "expected"),
    [("silent", ReplyTimeout), ("half_open", ReplyTimeout), ("hang_up", LinkLost),
     ("exception", DeviceFault), ("wrong_transaction", LinkError),
     ("wrong_function", ProtocolViolation), ("short", LinkError)],
)  # fmt: skip
async def test_faults_of_the_coupler(rig: IoRig, fault: str, expected: type[CellError]) -> None:
    rig.coupler.faults.inject(fault, 4)
    with pytest.raises(expected):
        await rig.io.read()
    with pytest.raises(expected):  # and so does every call until connect
        await rig.io.write({"lamp": True})
    rig.coupler.faults.clear()
    await good(rig)


async def test_late_split_and_merged_answers_are_waited_for(rig: IoRig) -> None:
    rig.coupler.faults.inject("late", 0.05)
    await rig.io.write({"clamp": True})
    rig.coupler.faults.clear()
    rig.coupler.faults.inject("split")
    rig.wire.forth.split = rig.wire.back.split = True
    state = await rig.io.read()
    assert dict(state.outputs) == {"lamp": False, "clamp": True}


@pytest.mark.parametrize("direction", ["forth", "back"])
async def test_half_open_wire(rig: IoRig, direction: str) -> None:
    await rig.io.write({"clamp": True})
    getattr(rig.wire, direction).blocked = True
    with pytest.raises(ReplyTimeout):
        await rig.io.write({"lamp": True})
    async with asyncio.timeout(2.0):
        while any(rig.coupler.outputs.values()):  # noqa: ASYNC110  the watchdog tells nobody
            await asyncio.sleep(0.01)
    getattr(rig.wire, direction).blocked = False
    await rig.io.connect()
    assert not any((await rig.io.read()).outputs.values())


@pytest.mark.parametrize("at", [0, 1, 3, 5, 7])
@pytest.mark.parametrize("direction", ["forth", "back"])
async def test_a_changed_header_is_a_fault(rig: IoRig, direction: str, at: int) -> None:
    getattr(rig.wire, direction).corrupt_in = at
    async with asyncio.timeout(2.0):
        while True:  # the changed byte may have gone into the poll of the driver
            try:
                await rig.io.read()
            except LinkError:
                break
    rig.wire.reset()
    await good(rig)


async def test_outputs_that_are_only_confirmed_are_seen(rig: IoRig) -> None:
    rig.coupler.faults.inject("deaf_outputs")
    await rig.io.write({"lamp": True})
    with pytest.raises(OutputsDropped, match="lamp"):
        await rig.io.read()
    rig.coupler.faults.clear()
    await good(rig)


async def test_a_pc_that_was_late_switches_nothing_on_again(rig: IoRig) -> None:
    await rig.io.write({"clamp": True})
    rig.coupler.drop_outputs()
    with pytest.raises(OutputsDropped):
        await rig.io.write({"lamp": True})
    writes = rig.coupler.writes
    with pytest.raises(OutputsDropped):
        await rig.io.read()
    await rig.io.connect()
    assert rig.coupler.writes == writes
    assert not any(rig.coupler.outputs.values())


async def test_the_poll_finds_out_by_itself(rig: IoRig) -> None:
    rig.coupler.drop_outputs()
    await rig.io.write({"clamp": True})
    rig.coupler.drop_outputs()
    async with asyncio.timeout(2.0):
        while rig.wire.connections:  # noqa: ASYNC110  the driver drops the link
            await asyncio.sleep(0.01)
    with pytest.raises(OutputsDropped):
        await rig.io.read()


@pytest.mark.parametrize("watchdog_ms", [0, 1001, 60_000])
async def test_a_coupler_that_would_not_switch_off_is_refused(rig: IoRig, watchdog_ms: int) -> None:
    await rig.io.disconnect()
    rig.coupler.watchdog_ms = watchdog_ms
    with pytest.raises(WatchdogUnsuitable):
        await rig.io.connect()
    with pytest.raises(LinkError):
        await rig.io.write({"lamp": True})


async def test_disconnecting_without_a_coupler_ends_in_time(rig: IoRig) -> None:
    await rig.io.write({"clamp": True})
    rig.wire.forth.blocked = True
    async with asyncio.timeout(1.0):
        await rig.io.disconnect()
    async with asyncio.timeout(2.0):
        while any(rig.coupler.outputs.values()):  # noqa: ASYNC110  the watchdog tells nobody
            await asyncio.sleep(0.01)


@pytest.mark.parametrize(
    "changes",
    [{"inputs": {"a": 1, "b": 1}}, {"outputs": {"a": 0, "b": 2000}}, {"inputs": {"Door": 0}},
     {"inputs": {"a": 0}, "outputs": {"a": 0}}, {"inputs": {"a": -1}}, {"inputs": {}},
     {"inputs": {"a": 0}, "max_watchdog_s": 0.0}, {"inputs": {"a": 0}, "speed": 1}],
)  # fmt: skip
def test_settings_that_are_refused(changes: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        ModbusCouplerConfig.model_validate({"host": "io"} | changes)


def test_valves_and_sensors_need_their_own_addresses() -> None:
    addresses = {"open_valve": 0, "close_valve": 1, "opened_sensor": 0, "closed_sensor": 1}
    PneumaticGripperConfig.model_validate({"host": "io", "part_sensor": 2} | addresses)
    with pytest.raises(ValidationError):
        PneumaticGripperConfig.model_validate({"host": "io", "part_sensor": 1} | addresses)


@pytest.fixture
async def gripper() -> AsyncIterator[GripperRig]:
    async with gripper_rig() as rig:
        await rig.gripper.connect()
        yield rig


async def test_the_valve_gets_one_coil_at_a_time(gripper: GripperRig) -> None:
    seen: list[dict[int, bool]] = []
    drive = gripper.coupler._on_outputs
    assert drive is not None

    def watched(time_s: float, outputs: dict[int, bool]) -> None:
        seen.append(dict(outputs))
        drive(time_s, outputs)

    gripper.coupler._on_outputs = watched  # type: ignore[assignment]
    await gripper.gripper.close()
    await gripper.gripper.open()
    assert {0: True, 1: True} not in seen
    assert seen[-1] == {0: True, 1: False}


async def test_a_part_sensor_that_is_a_little_late(gripper: GripperRig) -> None:
    gripper.jaws.broken["part"] = False
    closing = asyncio.create_task(gripper.gripper.close())
    async with asyncio.timeout(2.0):
        while not gripper.jaws.sensors(now_s())["closed"]:  # noqa: ASYNC110  physics tells nobody
            await asyncio.sleep(0.005)
    del gripper.jaws.broken["part"]
    assert (await closing).part_present
