"""What the steps of one assembly hand to each other: each state has what the next step needs."""

from dataclasses import dataclass

from scipy.spatial.transform import RigidTransform

from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.deck_to_frame.run import AssemblyRun
from cellctl.vision.registration.part_pose import PartPose


@dataclass(frozen=True, slots=True)
class Ready:
    """Deck clear of the station, heads over it; nothing is measured yet."""

    run: AssemblyRun


@dataclass(frozen=True, slots=True)
class FrameMeasured(Ready):
    """After step 10: the frame is measured."""

    frame: PartPose
    """The frame as measured by both heads."""

    @property
    def c1_T_M(self) -> RigidTransform:
        """Where the frame stands."""
        return self.frame.pose.pose


@dataclass(frozen=True, slots=True)
class DeckMeasured(FrameMeasured):
    """After step 20: the deck is measured."""

    flange_T_deck: RigidTransform
    """How the deck is gripped."""


@dataclass(frozen=True, slots=True)
class AtStandOff(DeckMeasured):
    """After step 30, and after each correction: the deck stands off from the frame."""

    commanded: RigidTransform
    """``M_T_D`` commanded last."""
    base_T_flange: RigidTransform
    """Flange pose commanded for it."""


@dataclass(frozen=True, slots=True)
class Corrected(AtStandOff):
    """After step 40: the deck is within its thresholds."""

    M_T_D: UncertainPose
    """The deck as last measured."""
    measured_at: RigidTransform
    """``base_T_flange`` as reported while ``M_T_D`` was measured."""


@dataclass(frozen=True, slots=True)
class Seated(Corrected):
    """After step 50: the deck is on the frame."""


@dataclass(frozen=True, slots=True)
class Verified(Seated):
    """After step 60: the seated deck is within the recipe's limit."""
