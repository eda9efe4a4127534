"""What valves and sensors of a pneumatic gripper mean, without I/O.

The valve is a double solenoid valve (5/2, two stable positions): a coil that is switched off leaves
the jaws where they are, which is why the gripper keeps its part when the coupler drops its outputs.
"""

from cellctl.interfaces.gripper import GripperState
from drivers.modbus.coupler import SignalReading

OPEN_VALVE, CLOSE_VALVE = "open_valve", "close_valve"
OPENED, CLOSED, PART = "opened_sensor", "closed_sensor", "part_sensor"

# Order matters: the valve answers to the coil that is alone, so the other one goes off first.
TO_OPEN = {CLOSE_VALVE: False, OPEN_VALVE: True}
TO_CLOSE = {OPEN_VALVE: False, CLOSE_VALVE: True}


def to_state(reading: SignalReading) -> GripperState:
    """The sensors' values as the interface names them."""
    values = reading.inputs
    return GripperState(reading.time_s, values[OPENED], values[CLOSED], values[PART])
