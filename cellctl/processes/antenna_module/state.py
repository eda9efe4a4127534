"""What the steps of one plugging hand to each other: each state has what the next step needs."""

from dataclasses import dataclass

from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.chain.looks import Looks, PlugLook
from cellctl.processes.antenna_module.chain.plan import PlugPlan
from cellctl.processes.antenna_module.insertion.verdict import InsertionJudgement
from cellctl.processes.antenna_module.run import PluggingRun


@dataclass(frozen=True, slots=True, eq=False)
class GripperEmpty:
    """Gripper open and empty, arm at home; nothing is measured yet."""

    run: PluggingRun


@dataclass(frozen=True, slots=True, eq=False)
class ModuleFound(GripperEmpty):
    """Camera I has seen the module on its tray."""

    base_T_connector: RigidTransform
    """Where its plug is, as far as the top shows it."""
    top_height_m: float
    """Height of the marks on its top along z of the base, judged by how large they look."""


@dataclass(frozen=True, slots=True, eq=False)
class HeldModule:
    """What was found out about the module while it was picked."""

    mass_kg: float
    hanging_n: Array
    """Raw force of the sensor with the module hanging free, shape (3,)."""
    top_over_flange_m: float
    """Height of its top over that of the flange, negative; the flange points down."""


@dataclass(frozen=True, slots=True, eq=False)
class ModuleHeld(GripperEmpty):
    """The module hangs in the gripper, clear of everything."""

    module: HeldModule


@dataclass(frozen=True, slots=True, eq=False)
class Picked(ModuleHeld):
    """The module was taken off its tray, and could be put back."""

    base_T_grip: RigidTransform
    """Where the flange was when the gripper closed."""


@dataclass(frozen=True, slots=True, eq=False)
class PlugInspected(ModuleHeld):
    """Camera II has seen plug and marks in one picture."""

    plug: PlugLook
    flange_T_connector: RigidTransform
    """The plug in the gripper by its drawing's frame, for ways and wrenches."""


@dataclass(frozen=True, slots=True, eq=False)
class SocketLocated(PlugInspected):
    """Camera I has seen the socket."""

    looks: Looks


@dataclass(frozen=True, slots=True, eq=False)
class Planned(SocketLocated):
    """Where the flange has to go."""

    plan: PlugPlan


@dataclass(frozen=True, slots=True, eq=False)
class OverSocket(Planned):
    """The tips stand over the socket's face; the force counts from here."""


@dataclass(frozen=True, slots=True, eq=False)
class Inserted(OverSocket):
    """The plug sits in its socket, held by the gripper."""

    judgement: InsertionJudgement


@dataclass(frozen=True, slots=True, eq=False)
class Released(Inserted):
    """The module was pulled, let go and seen in its place."""
