"""Targets on an arm at one place of its joints, kept to notice that the arm was moved since.

Seen again at the same joints by the same head, every target is where it was, unless the base of the
arm or the head was moved, a joint was mastered anew or exchanged, or a target was. Which of these
it was needs no kinematics to tell, and none is used: whatever rests on the arm is wrong then.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cellctl.errors.robot import ArmOffReference, ArmReferenceMissing
from cellctl.geometry.pose import MM, Array
from cellctl.interfaces.target_tracker import Target

LEAST_TARGETS = 3
"""Fewer may all lie where a turn of the arm does not move them."""
MOVED_M = 0.3e-3
"""A smaller displacement is no fault: temperature moves a target so far. A base of a metre of steel
grows by 0.06 mm with 5 K, and where one side of it is so much warmer it tilts the arm by 60 µrad,
which is 0.1 mm where the targets are: 0.27 mm at most, when all of it comes together."""
_SIGMAS = 5.0
"""Displacement over its standard deviation that counts as a fault where noise is what limits: for
normal noise in three directions it is exceeded about once in 60,000 looks at one target."""
_REPEATABILITY_M = 2e-5
"""Standard deviation of a coordinate of the arm, each time that it comes to the place."""


@dataclass(frozen=True, slots=True, eq=False)
class ArmReference:
    """One look at the arm."""

    joints_rad: Array
    """Shape (6,)."""
    targets: tuple[Target, ...]

    def to_record(self) -> dict[str, Any]:
        """Plain data, in mm and degrees."""
        return {
            "joints_deg": np.degrees(self.joints_rad).tolist(),
            "targets": [
                {
                    "name": target.name,
                    "position_mm": (target.position_m / MM).tolist(),
                    "sigma_mm": target.sigma_m / MM,
                }
                for target in self.targets
            ],
        }

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> "ArmReference":
        """The inverse of ``to_record``."""
        targets = (
            Target(
                str(entry["name"]),
                np.array(entry["position_mm"], dtype=float) * MM,
                float(entry["sigma_mm"]) * MM,
            )
            for entry in record["targets"]
        )
        return cls(np.radians(record["joints_deg"]), tuple(targets))


@dataclass(frozen=True, slots=True)
class TargetOffset:
    """How far a target is from its place in the reference."""

    name: str
    off_m: float
    limit_m: float
    """What noise and temperature explain."""

    @property
    def share(self) -> float:
        """Of the limit. A place that is not a number is off by any measure."""
        return math.inf if math.isnan(self.off_m) else self.off_m / self.limit_m


def target_offsets(then: ArmReference, now: ArmReference) -> tuple[TargetOffset, ...]:
    """Those of the targets that are seen again; raises ``ArmReferenceMissing`` for fewer than
    three."""
    pairs = _pairs(then.targets, now.targets)
    if len(pairs) < LEAST_TARGETS:
        names = ", ".join(target.name for target, _ in pairs) or "none"
        raise ArmReferenceMissing(f"of its targets these are seen again: {names}")
    return tuple(_offset(before, after) for before, after in pairs)


def require_arm_at_reference(offsets: Sequence[TargetOffset]) -> float:
    """The greatest distance of a target from its place in the reference, in m; at least one.

    Raises ``ArmOffReference`` when one is farther than noise explains.
    """
    worst = max(offsets, key=lambda one: one.share)
    if worst.share > 1.0:
        off, limit = worst.off_m / MM, worst.limit_m / MM
        raise ArmOffReference(f"{worst.name} {off:.3f} mm off, at most {limit:.3f} mm")
    return max(one.off_m for one in offsets)


def _offset(before: Target, after: Target) -> TargetOffset:
    off_m = float(np.linalg.norm(after.position_m - before.position_m))
    sigma_m = float(np.hypot(np.hypot(before.sigma_m, after.sigma_m), 2**0.5 * _REPEATABILITY_M))
    return TargetOffset(before.name, off_m, max(MOVED_M, _SIGMAS * sigma_m))


def _pairs(then: Sequence[Target], now: Sequence[Target]) -> list[tuple[Target, Target]]:
    seen = {target.name: target for target in now}
    return [(target, seen[target.name]) for target in then if target.name in seen]
