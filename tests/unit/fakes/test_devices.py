"""A cell of couplers and a gripper only: the hands of the operator reach their inputs and parts."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest

from fakes.cell import Cell, PortTaken
from fakes.scenario_file.sections import DigitalIo, Gripper
from fakes.scenes.plate.scenario import PlateScenario

SCENARIO = PlateScenario(
    scene="plate",
    hardware_seed=1,
    control_port=0,
    grippers={"jaws": Gripper(port=0, travel_ms=150, part_present=False, watchdog_ms=500)},
    digital_ios={
        "lamps": DigitalIo(port=0, inputs_on=(0,), inputs_off=(1,), outputs=(0, 1), watchdog_ms=0)
    },
)


@asynccontextmanager
async def running(scenario: PlateScenario) -> AsyncIterator[tuple[Cell, dict[str, int]]]:
    cell = Cell(scenario, 1)
    try:
        yield cell, await cell.start()
    finally:
        await cell.stop()


async def test_every_device_listens() -> None:
    async with running(SCENARIO) as (_, ports):
        assert set(ports) == {"jaws", "lamps", "control"}
        assert all(ports.values())


async def test_hands_switch_inputs_and_bring_parts() -> None:
    async with running(SCENARIO) as (cell, _):
        handlers = cell.operator.handlers()
        assert await handlers["outputs"](device="lamps") == {"outputs": {0: False, 1: False}}
        assert await handlers["set_input"](device="lamps", address=1, on=True) == {}
        with pytest.raises(ValueError, match="no input 9"):
            await handlers["set_input"](device="lamps", address=9, on=True)
        await handlers["set_part"](gripper="jaws", present=True)
        with pytest.raises(ValueError, match="unknown device 'claws'"):
            await handlers["set_part"](gripper="claws", present=True)
        await handlers["inject"](device="jaws", name="silent")
        await handlers["clear"](device="jaws")


async def test_a_taken_port_names_its_device() -> None:
    async with running(SCENARIO) as (_, ports):
        jaws = SCENARIO.grippers["jaws"].model_copy(update={"port": ports["jaws"]})
        second = SCENARIO.model_copy(update={"grippers": {"jaws": jaws}})
        cell = Cell(second, 1)
        with pytest.raises(PortTaken, match=f"port {ports['jaws']} of 'jaws' is in use"):
            await cell.start()
        await cell.stop()
