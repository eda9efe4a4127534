"""What a taught result belongs to, as names and identities, and how it is compared."""

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from typing import Any, ClassVar, Self

from cellctl.processes.antenna_module.chain.cell_figures import PlugCell
from cellctl.processes.antenna_module.faults.plugging import CalibrationsDoNotBelongTogether


@dataclass(frozen=True, slots=True)
class TaughtWith:
    """Base: every field is a string, those with a default are empty where it is not known."""

    what: ClassVar[str]
    """The result, in the words of the fault."""

    def require(self, used: Self) -> None:
        """Raise ``CalibrationsDoNotBelongTogether``, naming what differs from what is ``used``.

        What one side does not know is not compared: records of earlier versions, and files of looks
        that no cell has taken, say nothing of the content of drawings.
        """
        if other := self.differences(used):
            raise CalibrationsDoNotBelongTogether(f"{self.what} taught with {'; '.join(other)}")

    def differences(self, used: Self) -> list[str]:
        """What differs, as both sides name it."""
        then, now = self.to_record(), used.to_record()
        return [
            f"{key} {then[key]}, now {now[key]}"
            for key in now
            if then[key] and now[key] and then[key] != now[key]
        ]

    def to_record(self) -> dict[str, str]:
        """Plain data."""
        return {one.name: getattr(self, one.name) for one in fields(self)}

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> Self:
        """The inverse of ``to_record``; raises ``KeyError`` for what must be known."""
        names = [one.name for one in fields(cls) if one.default is MISSING or one.name in record]
        return cls(**{name: str(record[name]) for name in names})


@dataclass(frozen=True, slots=True)
class MadeWith(TaughtWith):
    """What a correction belongs to; another one of any of these makes it worthless."""

    what: ClassVar[str] = "correction"

    scheme: str
    cam1: str
    """Identity of the hand-eye calibration of camera I."""
    cam2: str
    camera_1: str
    """Identity of the intrinsics of camera I."""
    camera_2: str
    gripper: str
    connector: str
    """Names of plug and socket."""
    plug_drawing: str = ""
    """Identity of what the drawing says of the plug's places."""
    socket_drawing: str = ""
    gripper_drawing: str = ""

    @classmethod
    def of(cls, scheme: str, cell: PlugCell, plug: str, socket: str) -> "MadeWith":
        """What a teaching or a plan uses."""
        return cls(
            scheme=scheme,
            cam1=cell.cam1.id,
            cam2=cell.cam2.id,
            camera_1=cell.cam1.camera_id,
            camera_2=cell.cam2.camera_id,
            gripper=cell.gripper,
            connector=f"{plug} in {socket}",
            plug_drawing=cell.drawings.plug,
            socket_drawing=cell.drawings.socket,
            gripper_drawing=cell.drawings.gripper,
        )


@dataclass(frozen=True, slots=True)
class ReferenceMadeWith(TaughtWith):
    """What the places of a reference were computed with; they do not compare without it."""

    what: ClassVar[str] = "reference"

    cam1: str
    """Identity of the hand-eye calibration of camera I."""
    cam2: str
    gripper: str
    """Name of the drawing of its marks, wherever its file lies."""
    gripper_drawing: str = ""
    """Identity of what it says of the marks' places."""
    plate_above_drawing: str = ""
    plate_below_drawing: str = ""

    @classmethod
    def of(cls, cell: PlugCell) -> "ReferenceMadeWith":
        """What a check uses."""
        drawn = cell.drawings
        return cls(
            cell.cam1.id, cell.cam2.id, cell.gripper,
            drawn.gripper, drawn.plate_above, drawn.plate_below,
        )  # fmt: skip
