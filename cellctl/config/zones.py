"""Zones: parts of the cell's space that two arms may not share."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from cellctl.config.base import Millimetres, Section
from cellctl.config.devices import DeviceName

Corner = tuple[Millimetres, Millimetres, Millimetres]


class ZoneShare(Section):
    """Where one robot is in a zone: a box for its flange in the robot's own base frame.

    The box holds every place of the flange from which any part of arm, tool or load reaches into
    the space that is meant.
    """

    min_mm: Corner
    """The corner of the box with the least coordinates."""
    max_mm: Corner
    """The opposite corner."""
    clear_poses: tuple[DeviceName, ...] = ()
    """Taught poses between which the arm moves by joints without coming into the zone. Only for a
    robot whose driver does not know its kinematics: all its other joint moves need the zone."""

    way_out: Literal["-x", "+x", "-y", "+y", "-z", "+z"] | None = None
    """The face of the box through which the arm leaves while another one stands in the zone: the
    side away from where the others come in. Needed of a robot in ``retreat``."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not all(low < high for low, high in zip(self.min_mm, self.max_mm, strict=True)):
            raise ValueError("min_mm must lie below max_mm in every component")
        return self


class ZoneConfig(Section):
    """A space that belongs to one of these robots at a time."""

    robots: Annotated[dict[DeviceName, ZoneShare], Field(min_length=2)]
    retreat: tuple[DeviceName, ...] = ()
    """Robots in the order in which they leave when more than one of them is in the zone: each by
    moves that lead to its ``way_out`` and not along it, until they are beyond it, while the others
    stand. A robot that is not named waits until it is alone."""
    wait_s: Annotated[float, Field(ge=0.0, le=600.0)] = 30.0
    """How long a robot waits for another one that is on its way out."""

    @model_validator(mode="after")
    def _nobody_leaves_twice(self) -> Self:
        if len(set(self.retreat)) != len(self.retreat):
            raise ValueError("retreat names a robot twice")
        return self
