"""What a process says of the moves that it can command, for planning and checks offline."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum

from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array


class MoveKind(Enum):
    """What is straight on the way."""

    JOINT = "joint"
    """The joints: all begin and arrive together."""
    LINEAR = "linear"
    """The flange."""


@dataclass(frozen=True, slots=True, eq=False)
class StatedPlace:
    """Place at which an arm stands."""

    label: str
    """Name in words; a taught pose has its own."""
    joints_rad: Array
    """Shape (6,). Where the flange decides: joints near it, which tell how the arm is folded."""
    base_T_flange: RigidTransform | None = None
    """Pose of the flange; with None the joints decide."""


@dataclass(frozen=True, slots=True, eq=False)
class StatedMove:
    """One move that a process can command."""

    robot: str
    kind: MoveKind
    start: StatedPlace
    end: StatedPlace
    others: Mapping[str, tuple[StatedPlace, ...]] = field(default_factory=dict)
    """Every other arm with all the places at which it may be meanwhile."""
    approach: bool = False
    """True where bodies come together on purpose."""
    procedures: frozenset[int] = frozenset()
    """Numbers of the procedures which alone make this move; empty for one that a run makes too."""

    @property
    def name(self) -> str:
        """Name in findings."""
        return f"{self.robot}: {self.start.label} to {self.end.label} ({self.kind.value})"
