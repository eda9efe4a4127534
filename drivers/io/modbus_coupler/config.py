"""The settings of digital inputs and outputs behind a Modbus TCP coupler."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from drivers.modbus.settings import Address, CouplerSettings, check_addresses

SignalName = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,31}$", examples=["lamp_1"])]


class ModbusCouplerConfig(CouplerSettings):
    """The coupler, and the names of its signals with their addresses."""

    inputs: dict[SignalName, Address] = Field(default_factory=dict)
    outputs: dict[SignalName, Address] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _distinct(self) -> Self:
        if not (self.inputs or self.outputs):
            raise ValueError("name at least one input or output")
        check_addresses("inputs", self.inputs.values())
        check_addresses("outputs", self.outputs.values())
        # Records and messages name signals without their direction.
        if shared := self.inputs.keys() & self.outputs.keys():
            raise ValueError(f"input and output of one name: {', '.join(sorted(shared))}")
        return self
