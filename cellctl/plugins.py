"""Drivers and processes by name: entry points, loaded only when a cell file names them."""

from collections.abc import Callable, Mapping
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from cellctl.errors.config import UnknownDriver
from cellctl.spelling import nearest

ROBOT = "cellctl.robot"
STOP_CHANNEL = "cellctl.stop_channel"
STEREO_CAMERA = "cellctl.stereo_camera"
CAMERA = "cellctl.camera"
TARGET_TRACKER = "cellctl.target_tracker"
FT_SENSOR = "cellctl.ft_sensor"
GRIPPER = "cellctl.gripper"
DIGITAL_IO = "cellctl.digital_io"
PROCESS = "cellctl.process"
COMMAND = "cellctl.command"
"""Offline commands of a process: functions that add themselves to a Typer application."""
CALIBRATE = "cellctl.calibrate"
"""The same below `cellctl calibrate`."""
INSERTION_JUDGE = "cellctl.insertion_judge"
"""Functions that judge a recorded insertion (``cellctl.calibration.judged_insertion``)."""
WITH_FAULTS = (
    ROBOT,
    STOP_CHANNEL,
    STEREO_CAMERA,
    CAMERA,
    TARGET_TRACKER,
    FT_SENSOR,
    GRIPPER,
    DIGITAL_IO,
    PROCESS,
)
"""Groups whose packages may have a module ``faults`` with numbered faults of their own."""


def names(group: str) -> list[str]:
    """Names of the installed drivers of one kind."""
    return sorted(point.name for point in installed(group))


def load(group: str, name: str) -> type:
    """The driver class ``name``; raises ``UnknownDriver`` when absent or not importable."""
    loaded = _loaded(group, name)
    if not isinstance(loaded, type):
        raise UnknownDriver(f"{group} '{name}' is not a class")
    return loaded


def load_function(group: str, name: str) -> Callable[..., Any]:
    """The function ``name``; raises ``UnknownDriver`` when absent or not importable."""
    loaded = _loaded(group, name)
    if not callable(loaded):
        raise UnknownDriver(f"{group} '{name}' is not a function")
    return loaded


def _loaded(group: str, name: str) -> object:
    for point in installed(group):
        if point.name != name:
            continue
        try:
            return point.load()
        # A driver whose vendor's library is missing is a fault of this cell file, not a crash of
        # the command.
        except (ImportError, AttributeError) as error:
            raise UnknownDriver(f"{group} '{name}' cannot be imported: {error}") from error
    known = names(group)
    listed = ", ".join(known) or "none"
    raise UnknownDriver(f"no {group} named '{name}'; {nearest(name, known)}installed: {listed}")


def installed(group: str) -> tuple[EntryPoint, ...]:
    """Entry points of one kind."""
    return every().get(group, ())


@cache
def every() -> Mapping[str, tuple[EntryPoint, ...]]:
    """Entry points of all kinds of ours; what is installed does not change while a program runs.

    Remembered, because Python reads the metadata of every installed package for the answer, for one
    kind as for all, and a cell file asks dozens of times.
    """
    found = entry_points()
    ours = (group for group in found.groups if group.startswith("cellctl."))
    return {group: tuple(found.select(group=group)) for group in ours}
