"""Where the arm met the face of a hole, and whether it still does.

Panel and arm stand still between runs. An arm that was moved, or a joint that was mastered anew,
meets the panel elsewhere; so does a panel that has come loose.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.checks import Checks, LimitCheck
from cellctl.geometry.pose import MM, Array
from cellctl.processes.peg_in_hole.faults import PanelOffReference


@dataclass(frozen=True, slots=True, eq=False)
class PanelReference:
    """A plane in the base of the arm."""

    base_r_point_m: Array
    """A point of it, over the hole; shape (3,)."""
    base_normal: Array
    """Unit normal into the panel; shape (3,)."""

    @classmethod
    def of(cls, base_T_task: RigidTransform) -> Self:
        """The plane that frame A lies on, once it was put onto the face."""
        return cls(base_T_task.translation, base_T_task.rotation.as_matrix()[:, 2])

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> Self:
        """Raises ``ValueError`` for what is no plane."""
        point_mm = np.array(record["base_r_point_mm"], dtype=float)
        normal = np.array(record["base_normal"], dtype=float)
        if point_mm.shape != (3,) or normal.shape != (3,) or not np.isfinite(point_mm).all():
            raise ValueError("a point and a normal of three numbers each")
        if not abs(float(np.linalg.norm(normal)) - 1.0) < 1e-6:
            raise ValueError("the normal has not the length 1")
        return cls(point_mm * MM, normal)

    def to_record(self) -> dict[str, Any]:
        """Plain data, lengths in mm."""
        return {
            "base_r_point_mm": (self.base_r_point_m / MM).tolist(),
            "base_normal": self.base_normal.tolist(),
        }

    def checks(self, base_T_task: RigidTransform, most_mm: float, most_deg: float) -> Checks:
        """How far the face that was touched now lies from this plane, and how it is turned."""
        now = PanelReference.of(base_T_task)
        beside_m = float(self.base_normal @ (now.base_r_point_m - self.base_r_point_m))
        sine = float(np.linalg.norm(np.cross(self.base_normal, now.base_normal)))
        turned_deg = float(np.degrees(np.arctan2(sine, self.base_normal @ now.base_normal)))
        return (
            LimitCheck("face beside its reference", abs(beside_m) / MM, most_mm, "mm"),
            LimitCheck("face turned from its reference", turned_deg, most_deg, "°"),
        )


def require_panel_at_reference(checks: Checks) -> None:
    """Raise ``PanelOffReference`` with every figure that is beyond its limit."""
    beyond = [str(check) for check in checks if not check.passed]
    if beyond:
        raise PanelOffReference("; ".join(beyond))
