"""The pneumatic gripper's driver and its coupler, with a chaos proxy between them."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass

from cellctl.clock import now_s
from drivers.gripper.pneumatic.config import PneumaticGripperConfig
from drivers.gripper.pneumatic.driver import PneumaticGripper
from fakes.wire.couplers.coupler import CouplerServer
from fakes.wire.couplers.gripper_coupler import CLOSE_COIL, OPEN_COIL, SENSORS, gripper_coupler
from fakes.world.gripper import PneumaticJaws
from tests.rigs.wire.proxy import ChaosProxy


@dataclass
class GripperRig:
    """Driver, jaws, coupler and the wire between."""

    gripper: PneumaticGripper
    jaws: PneumaticJaws
    coupler: CouplerServer
    wire: ChaosProxy
    settings: PneumaticGripperConfig


@asynccontextmanager
async def gripper_rig(**changes: object) -> AsyncIterator[GripperRig]:
    """Wired up, not connected."""
    jaws = PneumaticJaws(travel_s=0.1)
    coupler = gripper_coupler(jaws, now_s, watchdog_ms=900)
    async with ChaosProxy(await coupler.start()) as wire:
        settings: dict[str, object] = {
            "host": "127.0.0.1",
            "port": wire.port,
            "reply_timeout_s": 0.6,
            "open_valve": OPEN_COIL,
            "close_valve": CLOSE_COIL,
            "opened_sensor": SENSORS["opened"],
            "closed_sensor": SENSORS["closed"],
            "part_sensor": SENSORS["part"],
            "travel_timeout_s": 0.6,
            "part_delay_s": 0.1,
        }
        config = PneumaticGripperConfig.model_validate(settings | changes)
        gripper = PneumaticGripper("gripper", config)
        yield GripperRig(gripper, jaws, coupler, wire, config)
        await gripper.disconnect()
    await coupler.stop()
