"""The coupler that carries the signals of one section of the cell file."""

from drivers.io.modbus_coupler.config import ModbusCouplerConfig
from drivers.modbus.coupler import Coupler


def coupler(name: str, config: ModbusCouplerConfig) -> Coupler:
    """The coupler of a cell file's device, not connected yet."""
    return Coupler(name, config, config.inputs, config.outputs)
