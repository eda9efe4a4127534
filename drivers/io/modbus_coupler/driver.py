"""Digital inputs and outputs behind a Modbus TCP coupler (docs/protocols/modbus-coupler.md)."""

from collections.abc import Mapping
from typing import Any

from cellctl.interfaces.digital_io import DigitalIo, DigitalIoState, IoNames
from drivers.io.modbus_coupler import faults, protocol
from drivers.io.modbus_coupler.config import ModbusCouplerConfig
from drivers.io.modbus_coupler.connection import coupler


class ModbusCouplerIo(DigitalIo):
    """The names are those of the configuration."""

    Config = ModbusCouplerConfig

    def __init__(self, name: str, config: ModbusCouplerConfig) -> None:
        self.name = name
        self.input_names = tuple(config.inputs)
        self.output_names = tuple(config.outputs)
        self._coupler = coupler(name, config)

    @classmethod
    def names(cls, config: Any) -> IoNames:
        """As the configuration names them."""
        settings = ModbusCouplerConfig.model_validate(config)
        return IoNames(tuple(settings.inputs), tuple(settings.outputs))

    async def connect(self) -> None:
        """Connect and check the coupler's watchdog. Idempotent."""
        await self._coupler.connect()

    async def disconnect(self) -> None:
        """Switch every output off and drop the link."""
        await self._coupler.disconnect()

    async def let_go(self) -> None:
        """Drop the link and switch nothing."""
        await self._coupler.let_go()

    async def read(self) -> DigitalIoState:
        """Functions 2 and 1, now."""
        return protocol.to_state(await self._coupler.read())

    async def write(self, outputs: Mapping[str, bool]) -> None:
        """Function 5 for each output, in the order given."""
        # Before the first output is written: half of an order must not be carried out.
        if unknown := sorted(outputs.keys() - set(self.output_names)):
            raise faults.unknown(self.name, unknown, self.output_names)
        await self._coupler.write(outputs)
