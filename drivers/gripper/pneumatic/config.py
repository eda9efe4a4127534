"""The settings of a pneumatic gripper behind a Modbus TCP coupler. Seconds."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from drivers.modbus.settings import Address, CouplerSettings, Seconds, check_addresses


class PneumaticGripperConfig(CouplerSettings):
    """The coupler, the two coils of the valve, and the three sensors."""

    open_valve: Address
    close_valve: Address
    opened_sensor: Address
    closed_sensor: Address
    """Active from the closing position on a part of nominal size to the closed end position."""
    part_sensor: Address
    travel_timeout_s: Seconds = 2.0
    """From the valve's switching to the end position."""
    part_delay_s: Annotated[float, Field(ge=0.0, le=5.0)] = 0.2
    """After closing, the part sensor may take this long to show a part."""
    poll_s: Annotated[float, Field(ge=0.005, le=0.5)] = 0.02
    """Pause between two readings of the sensors while the jaws travel."""

    @model_validator(mode="after")
    def _distinct(self) -> Self:
        check_addresses("open_valve and close_valve", (self.open_valve, self.close_valve))
        check_addresses(
            "opened_sensor, closed_sensor and part_sensor",
            (self.opened_sensor, self.closed_sensor, self.part_sensor),
        )
        return self
