"""The load of an arm, and what is chosen at its pendant."""

from dataclasses import dataclass

from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array


@dataclass(frozen=True, slots=True, eq=False)
class ArmLoad:
    """Everything that hangs on the flange, the force sensor included."""

    mass_kg: float
    flange_r_com_m: Array | None
    """Centre of mass in the flange, shape (3,); None where it is not known."""


@dataclass(frozen=True, slots=True, eq=False)
class PendantSelection:
    """What a controller reckons with; None for what it does not tell."""

    load: ArmLoad | None = None
    flange_T_tool: RigidTransform | None = None
    """Frame of the tool that is chosen."""
    base_T_work: RigidTransform | None = None
    """Frame of the work object that is chosen."""
