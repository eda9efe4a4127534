"""The correction from taught plugs: one pose per slot that turns constant errors into nothing."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.checks import Checks, all_passed, checks_from_record, evidence_to_record
from cellctl.calibration.pose_record import matrix_mm_to_pose, pose_from_record, pose_to_record
from cellctl.geometry.pose import MM, Array, pose_to_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.geometry.wrist import WRIST_JOINTS
from cellctl.processes.antenna_module.chain.teaching.made_with import MadeWith
from cellctl.processes.antenna_module.faults.plugging import (
    OutOfTaughtRange,
)


@dataclass(frozen=True, slots=True, eq=False)
class TaughtSlot:
    """The correction at one socket of the panel."""

    name: str
    base_T_socket: RigidTransform
    """Mean of the sockets that it was taught with."""
    socket_T_plug: UncertainPose
    """The correction: where the plug is said to be in the socket once it sits in it."""
    plugs: int
    scatter_m: float
    """Standard deviation of single plugs, per axis in the plane."""
    scatter_rad: float
    """The same of their yaw."""
    from_mean: Array = field(default_factory=lambda: np.zeros((0, 3)))
    """x and y (m) and yaw (rad) of the single plugs from their mean, shape (n, 3); for the picture,
    not in the record."""


@dataclass(frozen=True, slots=True, eq=False)
class PlugCorrection:
    """All taught slots of one connector."""

    made_with: MadeWith
    wrist: tuple[int, ...]
    """Configuration of the arm, ``geometry.wrist.wrist_configuration``."""
    range_m: float
    """How far from a taught slot it holds."""
    slots: tuple[TaughtSlot, ...]
    checks: Checks

    method = "mean of taught plugs"

    @property
    def passed(self) -> bool:
        """The verdict."""
        return all_passed(self.checks)

    def slot_for(self, base_T_socket: RigidTransform) -> tuple[TaughtSlot, float]:
        """The nearest slot and its distance in m; raises ``OutOfTaughtRange``."""
        # Errors of cameras and hand-eye cancel at the place of the teaching, and less and less away
        # from it: hence the nearest slot, and a range.
        distances = [_distance(slot.base_T_socket, base_T_socket) for slot in self.slots]
        nearest = int(np.argmin(distances))
        # Written so that a distance that is not a number is out of range.
        if not distances[nearest] <= self.range_m:
            raise OutOfTaughtRange(
                f"{distances[nearest] / MM:.0f} mm from slot {self.slots[nearest].name}, "
                f"allowed {self.range_m / MM:.0f} mm"
            )
        return self.slots[nearest], distances[nearest]

    def to_record(self) -> dict[str, Any]:
        """Plain data for the store."""
        return {
            **evidence_to_record(self.method, self.checks),
            "made_with": self.made_with.to_record(),
            "wrist": list(self.wrist),
            "range_mm": self.range_m / MM,
            "slots": [_slot_to_record(slot) for slot in self.slots],
        }

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> "PlugCorrection":
        """The inverse of ``to_record``.

        Raises ``KeyError``, ``TypeError`` or ``ValueError`` for a damaged one.
        """
        slots = tuple(_slot_from_record(slot) for slot in record["slots"])
        if not slots:
            raise ValueError("a plug correction has at least one slot")
        wrist = tuple(int(sign) for sign in record["wrist"])
        if len(wrist) != len(WRIST_JOINTS) or not {*wrist} <= {-1, 1}:
            raise ValueError(f"a wrist configuration is the signs of two joints, got {wrist}")
        return cls(
            made_with=MadeWith.from_record(record["made_with"]),
            wrist=wrist,
            range_m=float(record["range_mm"]) * MM,
            slots=slots,
            checks=checks_from_record(record["checks"]),
        )


def _distance(a: RigidTransform, b: RigidTransform) -> float:
    offset: Array = a.translation - b.translation
    return float(np.linalg.norm(offset))


def _slot_to_record(slot: TaughtSlot) -> dict[str, Any]:
    return {
        "name": slot.name,
        "base_T_socket": pose_to_xyzabc(slot.base_T_socket).tolist(),
        "socket_T_plug": pose_to_record(slot.socket_T_plug),
        "plugs": slot.plugs,
        "scatter_um": slot.scatter_m * 1e6,
        "scatter_deg": float(np.degrees(slot.scatter_rad)),
    }


def _slot_from_record(record: Mapping[str, Any]) -> TaughtSlot:
    return TaughtSlot(
        name=str(record["name"]),
        base_T_socket=matrix_mm_to_pose(record["base_T_socket"]),
        socket_T_plug=pose_from_record(record["socket_T_plug"]),
        plugs=int(record["plugs"]),
        scatter_m=float(record["scatter_um"]) * 1e-6,
        scatter_rad=float(np.radians(record["scatter_deg"])),
    )
