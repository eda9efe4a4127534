"""The files of ``cellctl plan-plug`` and ``cellctl calibrate plug``."""

from pathlib import Path
from typing import Any, Literal, TypeVar

from pydantic import Field, ValidationError

from cellctl.calibration.input_file import InputFile, InputPose, error_words, read_input
from cellctl.errors.config import FileInvalid
from cellctl.processes.antenna_module.chain.looks import (
    Look,
    Looks,
    PlateLook,
    PlugLook,
    SocketLook,
)
from cellctl.processes.antenna_module.chain.teaching.teaching import TaughtPlug
from cellctl.processes.antenna_module.commands.cell_file import (
    AnyObject,
    CellEntries,
    Joints,
    read_relative,
)
from cellctl.processes.antenna_module.commands.measurement_file import Identity, Measurement


class LookEntry(InputFile):
    """One picture, and where the robot was."""

    station: Literal["plug", "socket", "reference"]
    base_T_flange: InputPose
    joints_deg: Joints
    measurement: Measurement
    by_fixed_camera: Measurement | None = None
    """At the station ``reference``: the same plate in camera II."""
    time_s: float

    def common(self) -> tuple[Any, Any, float, str]:
        """The fields of every look."""
        return self.base_T_flange, self.joints_deg, self.time_s, self.measurement.camera_id


def looks_of(entries: tuple[LookEntry, ...]) -> Looks:
    """The looks by station; raises ``ValueError`` when they are not one plug and its sockets."""
    by_station = {
        station: [entry for entry in entries if entry.station == station]
        for station in ("plug", "socket", "reference")
    }
    plugs, plates = by_station["plug"], by_station["reference"]
    if len(plugs) != 1:
        raise ValueError(f"looks: {len(plugs)} at the station plug, exactly one needed")
    if len(plates) > 1:
        raise ValueError(f"looks: {len(plates)} at the station reference, at most one")
    plug = plugs[0]
    return Looks(
        PlugLook(
            *plug.common(),
            plug.measurement.connector_pose(),
            plug.measurement.marks_pose(),
            plug.measurement.connector,
        ),
        tuple(
            SocketLook(
                *entry.common(), entry.measurement.connector_pose(), entry.measurement.connector
            )
            for entry in by_station["socket"]
        ),
        _plate(plates[0]) if plates else None,
    )


def _plate(entry: LookEntry) -> PlateLook:
    fixed = entry.by_fixed_camera
    if fixed is None:
        raise ValueError("looks: the station reference needs by_fixed_camera, too")
    return PlateLook(
        Look(*entry.common()),
        entry.measurement.connector_pose(),
        fixed.connector_pose(),
        fixed.camera_id,
    )


class TrialFile(CellEntries):
    """One plugging to be planned."""

    looks: tuple[LookEntry, ...]
    correction: dict[str, Any] | None = None
    """As ``cellctl calibrate plug`` has written it."""
    connector: str | None = None
    """Name of the file with the plug's drawing, beside this one."""
    tolerance_um: float = Field(default=50.0, gt=0, le=1000)
    time_s: float | None = None
    """When it is planned, on the clock of the looks; without it, when the last look was taken."""

    def now_s(self) -> float:
        """When it is planned."""
        return max(look.time_s for look in self.looks) if self.time_s is None else self.time_s


class TaughtEntry(InputFile):
    """One taught plug."""

    name: Identity | None = None
    slot: Identity = "slot"
    looks: tuple[LookEntry, ...]
    plugged_base_T_flange: InputPose
    """Read while the plug sat in its socket."""

    def plug(self, unnamed: str) -> TaughtPlug:
        """Input of the solver; ``unnamed`` is its name where the file gives none."""
        return TaughtPlug(self.name or unnamed, looks_of(self.looks), self.plugged_base_T_flange)


class TeachFile(CellEntries):
    """Plugs of one or more slots."""

    plugs: tuple[TaughtEntry, ...]
    checked_plugs: tuple[TaughtEntry, ...] = ()
    """Plugs that the correction is not taught with but checked with."""
    range_mm: float = Field(default=200.0, gt=0, le=1000)
    """How far from a taught slot the correction may be used."""

    def by_slot(self) -> dict[str, list[TaughtPlug]]:
        """The plugs of each slot; raises ``ValueError`` like ``looks_of``."""
        slots: dict[str, list[TaughtPlug]] = {}
        for number, entry in enumerate(self.plugs, start=1):
            slots.setdefault(entry.slot, []).append(entry.plug(f"plug {number}"))
        return slots

    def checked(self) -> list[TaughtPlug]:
        """The plugs to check with; raises ``ValueError`` like ``looks_of``."""
        return [
            entry.plug(f"checked plug {number}")
            for number, entry in enumerate(self.checked_plugs, start=1)
        ]


F = TypeVar("F", bound=CellEntries)
_MAY_BE_FILES = ("flange_T_cam1", "base_T_cam2", "correction")


def read_cell_file(path: Path, model: type[F]) -> F:
    """Read a file in which calibrations, and measurements of looks, may be names of other files.

    Raises ``FileInvalid`` with everything that is wrong.
    """
    content = read_input(path, AnyObject).root()
    for key in _MAY_BE_FILES:
        if key in content:
            content[key] = read_relative(path, content[key])
    for looks in _looks_in(content):
        for look in looks:
            for key in ("measurement", "by_fixed_camera"):
                if key in look:
                    look[key] = read_relative(path, look[key])
    try:
        return model.model_validate(content)
    except ValidationError as error:
        raise FileInvalid(f"{path}: {error_words(error)}") from error


def _looks_in(content: dict[str, Any]) -> list[list[dict[str, Any]]]:
    """The lists of looks of a trial or of a teaching, as far as they are such."""
    plugs = [content.get(key) for key in ("plugs", "checked_plugs")]
    holders = [content, *(one for some in plugs if isinstance(some, list) for one in some)]
    lists = [holder.get("looks") for holder in holders if isinstance(holder, dict)]
    return [
        [look for look in looks if isinstance(look, dict)]
        for looks in lists
        if isinstance(looks, list)
    ]
