"""Sections of the scenario file that describe plates, printed boards and payloads."""

from typing import Literal, Self

from pydantic import Field, model_validator

from fakes.scenario_file.scenario import Scenario
from fakes.scenario_file.sections import DeviceName, Pair, Pose, Section, Spread, Springs, Three


class PlateHole(Section):
    """A hole in the upper face of a plate."""

    name: str
    kind: Literal["pin", "thread", "countersink"] = "pin"
    position_mm: Pair
    """Position from the middle of the plate."""
    diameter_mm: float
    """Diameter of a plain bore, of the thread, or of the bore inside a countersink."""
    countersink_mm: float | None = None
    """Outer diameter of the countersink."""
    through: bool = True
    """Whether one sees the background at its end."""


class Plate(Section):
    """A flat plate; its frame lies in the middle of its upper face, z upwards."""

    size_mm: Pair
    thickness_mm: float
    cell_T_plate_mm_deg: Pose
    placement: Spread
    """How far it lies beside its nominal pose, drawn at every load."""
    hole_sigma_mm: float
    """Machining error of a hole's position, each coordinate."""
    holes: tuple[PlateHole, ...] = ()


class PrintedBoard(Section):
    """A flat chessboard; its frame lies in the middle of the print, z upwards."""

    inner_corners: tuple[int, int]
    square_mm: float
    size_mm: Pair
    cell_T_board_mm_deg: Pose
    placement: Spread


class CarriedPayload(Springs):
    """What is mounted behind a force sensor."""

    mass_kg: float
    com_in_sensor_mm: Three


class PlateScenario(Scenario):
    """The whole file; any number of bodies of each kind."""

    plates: dict[str, Plate] = Field(default_factory=dict)
    boards: dict[str, PrintedBoard] = Field(default_factory=dict)
    payloads: dict[DeviceName, CarriedPayload] = Field(default_factory=dict)
    """Payloads by the force sensor that they hang behind; a sensor without one carries nothing."""

    @model_validator(mode="after")
    def _payloads_hang_behind_sensors(self) -> Self:
        if strangers := sorted(set(self.payloads) - set(self.force_sensors)):
            raise ValueError(f"payloads: there are no force sensors {', '.join(strangers)}")
        return self
