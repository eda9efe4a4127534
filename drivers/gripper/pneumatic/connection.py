"""The coupler that carries valves and sensors of one gripper."""

from drivers.gripper.pneumatic.config import PneumaticGripperConfig
from drivers.gripper.pneumatic.protocol import CLOSE_VALVE, CLOSED, OPEN_VALVE, OPENED, PART
from drivers.modbus.coupler import Coupler


def coupler(name: str, config: PneumaticGripperConfig) -> Coupler:
    """The coupler of a gripper, not connected yet."""
    return Coupler(
        name,
        config,
        inputs={
            OPENED: config.opened_sensor,
            CLOSED: config.closed_sensor,
            PART: config.part_sensor,
        },
        outputs={OPEN_VALVE: config.open_valve, CLOSE_VALVE: config.close_valve},
    )
