"""The keys that the recipes of all processes have in common."""

from collections.abc import Mapping, Sequence
from enum import StrEnum
from typing import Annotated, TypeVar

from pydantic import Field

from cellctl.config.base import Section
from cellctl.config.devices import DeviceName


class LineLostAction(StrEnum):
    """The reaction of a step in contact when the line PLC's heartbeat is lost."""

    KEEP = "stop-and-keep"
    """All robots stop and latch at once; the arm stays where it is, under force if there is one."""
    BACK_OFF = "stop-and-back-off"
    """The robot stops and leaves the contact as after a fault of the process."""
    FINISH = "finish"
    """The contact is finished; the run holds at the next safe point, or ends."""


class Recipe(Section):
    """One product. A process derives its own recipe from this one and adds its figures."""

    process: Annotated[str, Field(min_length=1, max_length=64)]
    """Name of the process (entry point ``cellctl.process``) that carries it out."""
    id: Annotated[int, Field(ge=1, le=99)]
    """Number by which the line asks for it."""
    name: Annotated[str, Field(min_length=1, max_length=64)]
    """On screens and reports; a person may ask for it by this name, too."""
    roles: dict[DeviceName, DeviceName] = Field(default_factory=dict)
    """Device for each role of the process that the device of the role's own name does not take."""
    line_lost_in_contact: LineLostAction = LineLostAction.KEEP
    """Steps without contact hold at the next safe point, whatever stands here."""

    def files(self) -> Mapping[str, str]:
        """Files that belong to it, relative to the cell file, by the name of their record."""
        return {}

    def device(self, role: str) -> str:
        """Name of the device that takes a role."""
        # By default the device with the role's own name, so that the usual cell needs no table of
        # roles.
        return self.roles.get(role, role)


R = TypeVar("R", bound=Recipe)


def first_of_each(recipes: Sequence[R], role: str) -> list[R]:
    """The first recipe of each device in a role, for what is done once for each device."""
    return list({recipe.device(role): recipe for recipe in reversed(recipes)}.values())
