"""The drawings that a recipe and the settings of the process name."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cellctl.geometry.pose import MM, Array
from cellctl.processes.antenna_module.connector.connector import Connector, read_connector
from cellctl.processes.antenna_module.connector.marks import Marks, read_marks
from cellctl.processes.antenna_module.faults.connector import ConnectorFileInvalid
from cellctl.processes.antenna_module.recipe import AntennaRecipe, Place
from cellctl.processes.antenna_module.settings import ReferenceSection


@dataclass(frozen=True, slots=True, eq=False)
class Drawings:
    """Both connectors, the gripper's marks and the top of the module."""

    plug: Connector
    socket: Connector
    gripper: Marks
    top: Marks


def read_drawings(recipe: AntennaRecipe, folder: Path) -> Drawings:
    """Read the files of a recipe beside the cell file.

    Raises ``ConnectorFileInvalid`` or ``MarksFileInvalid``, also when plug and socket are exchanged
    or do not fit each other.
    """
    plug, socket = read_connector(folder / recipe.plug), read_connector(folder / recipe.socket)
    for connector, kind, key in ((plug, "pins", "plug"), (socket, "holes", "socket")):
        if connector.kind != kind:
            raise ConnectorFileInvalid(f"{key}: {connector.name} has {connector.kind}, not {kind}")
    if set(plug.contacts) != set(socket.contacts):
        raise ConnectorFileInvalid(f"contacts of {plug.name} and {socket.name} are not the same")
    _require_fit(plug, socket)
    gripper = read_marks(folder / recipe.gripper_marks)
    return Drawings(plug, socket, gripper, read_marks(folder / recipe.module_top))


def _require_fit(plug: Connector, socket: Connector) -> None:
    """Distances between contacts of the same names are equal, seen from either side."""
    order = [socket.contacts.index(name) for name in plug.contacts]
    wanted, found = _distances(plug.positions_m), _distances(socket.positions_m[order])
    apart_m = float(np.abs(wanted - found).max())
    if apart_m > socket.capture_m:
        raise ConnectorFileInvalid(
            f"contacts of {plug.name} and {socket.name} do not fit each other: two of them are "
            f"{apart_m / MM:.2f} mm farther apart in one than in the other"
        )


def _distances(positions_m: Array) -> Array:
    apart_m: Array = np.linalg.norm(positions_m[:, None] - positions_m[None], axis=2)
    return apart_m


@dataclass(frozen=True, slots=True, eq=False)
class Plate:
    """The reference plate as either camera sees it."""

    above: Marks
    """The marks that camera I sees."""
    below: Marks
    """The marks that camera II sees."""
    base_T_plate: Place


def read_plate(section: ReferenceSection, folder: Path) -> Plate:
    """Read the drawings of the plate beside the cell file; raises ``MarksFileInvalid``."""
    above, below = (
        read_marks(folder / name) for name in (section.plate_above, section.plate_below)
    )
    return Plate(above, below, section.base_T_plate)
