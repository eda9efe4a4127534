"""The world at one moment, for everything that looks at it."""

from dataclasses import dataclass

from scipy.spatial.transform import RigidTransform

from fakes.scenario import RobotName, Scenario
from fakes.world.truth import PartsTruth, WorldTruth


@dataclass(frozen=True, slots=True)
class Placed:
    """What the operator has put into the cell; poses of boards in the cell."""

    parts: PartsTruth | None = None
    frame: bool = True
    deck: bool = True
    target_board: RigidTransform | None = None
    chessboard: RigidTransform | None = None


@dataclass(frozen=True, slots=True)
class Snapshot:
    """True poses; ``cell`` is the base frame of the main robot."""

    scenario: Scenario
    seed: int
    """Of the run: parts, noise, placements; the devices have a seed of their own."""
    truth: WorldTruth
    time_s: float
    placed: Placed
    flanges: dict[RobotName, RigidTransform]
    """cell_T_flange of each arm."""
    cell_T_deck: RigidTransform | None
    """None when there is no deck in the gripper."""
    loads: int
    contact_force_n: float
    peak_contact_force_n: float
