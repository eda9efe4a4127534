"""The drawings that a recipe and the settings of the process name."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cellctl.geometry.pose import MM, Array
from cellctl.processes.antenna_module.connector.connector import Connector, read_connector
from cellctl.processes.antenna_module.connector.marks import Marks, read_marks
from cellctl.processes.antenna_module.faults.connector import ConnectorFileInvalid
from cellctl.processes.antenna_module.mated import MATED_TURN
from cellctl.processes.antenna_module.recipe import AntennaRecipe, Place
from cellctl.processes.antenna_module.settings import ReferenceSection

_DRAWN_OTHERWISE = {
    "is mirrored in x": (-1.0, 1.0),
    "has its rows exchanged": (1.0, -1.0),
    "is turned by half a turn": (-1.0, -1.0),
}
"""What somebody draws who looks at the other face, or holds the part the other way."""
_WIDEST = 1.8
"""Bore of a hole over its pin: springs bridge some tenths; twice as much is a radius for one."""


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
        raise ConnectorFileInvalid(
            f"contacts of {plug.name} and {socket.name} are not the same"
            f"{_lacks(recipe.plug, plug, socket)}{_lacks(recipe.socket, socket, plug)}"
        )
    _require_fit(plug, socket)
    gripper = read_marks(folder / recipe.gripper_marks)
    return Drawings(plug, socket, gripper, read_marks(folder / recipe.module_top))


def _lacks(file: str, connector: Connector, other: Connector) -> str:
    missing = [name for name in other.contacts if name not in connector.contacts]
    return f"; {file} ({connector.kind}) lacks {', '.join(missing)}" if missing else ""


def _require_fit(plug: Connector, socket: Connector) -> None:
    """Every contact of the plug lies on that of its name in the socket, and its pin goes in."""
    order = [socket.contacts.index(name) for name in plug.contacts]
    mated_m = socket.positions_m[order] @ MATED_TURN.rotation.as_matrix()[:2, :2]
    off_m = _farthest_m(plug.positions_m - mated_m)
    if off_m > socket.capture_m:
        names = f"contacts of plug {plug.name} and socket {socket.name} do not fit each other"
        for what, change in _DRAWN_OTHERWISE.items():
            if _farthest_m(plug.positions_m * change - mated_m) <= socket.capture_m:
                raise ConnectorFileInvalid(
                    f"{names}: one of the drawings {what}; each is drawn as seen on its own mating "
                    "face, so that contacts of one name have the same y and the other sign of x"
                )
        raise ConnectorFileInvalid(
            f"{names}: plugged in, two of one name are {off_m / MM:.2f} mm apart"
        )
    if not plug.diameter_m < socket.diameter_m < _WIDEST * plug.diameter_m:
        raise ConnectorFileInvalid(
            f"pins of {plug.diameter_m / MM:g} mm (plug {plug.name}) for holes of "
            f"{socket.diameter_m / MM:g} mm (socket {socket.name}): holes are wider than their "
            f"pins and less than {_WIDEST:g} times as wide; or one is a radius"
        )


def _farthest_m(off_m: Array) -> float:
    return float(np.linalg.norm(off_m, axis=1).max())


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
