"""What the bits of a coupler mean for the interface, without I/O."""

from types import MappingProxyType

from cellctl.interfaces.digital_io import DigitalIoState
from drivers.modbus.coupler import SignalReading


def to_state(reading: SignalReading) -> DigitalIoState:
    """All signals by their names, read-only."""
    return DigitalIoState(
        # Read-only views: a frozen state whose mappings can be changed would only look frozen.
        reading.time_s,
        MappingProxyType(reading.inputs),
        MappingProxyType(reading.outputs),
    )
