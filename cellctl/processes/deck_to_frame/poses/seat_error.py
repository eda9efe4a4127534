"""How far a seated deck is from its seat."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import MM, Array
from cellctl.processes.deck_to_frame.poses.pose_correction import assembly_error
from cellctl.vision.features.hole import Hole


@dataclass(frozen=True, slots=True, eq=False)
class SeatError:
    """A seated deck as the cameras saw it."""

    error: Array
    """Seat minus measured, shape (6,): x, y, z in m and rx, ry, rz in rad, in the axes of M."""
    offsets_mm: Mapping[str, float]
    """Lateral distance of each judged hole from its place, by the name of the hole."""

    @property
    def gap_mm(self) -> float:
        """Between deck and frame in the middle of the face; positive when the deck stands off."""
        # The error is seat minus measured, so a deck that stands too high has a negative z.
        return -float(self.error[2]) / MM

    @property
    def rotation_deg(self) -> float:
        """About the worst axis."""
        return float(np.degrees(np.abs(self.error[3:]).max()))


def pin_holes(holes: Sequence[Hole]) -> list[Hole]:
    """The holes that a pin enters and that a person can gauge."""
    return [hole for hole in holes if hole.kind == "pin"]


def seat_error(M_T_D: RigidTransform, thickness_m: float, holes: Sequence[Hole]) -> SeatError:
    """Error of a seated deck, judged at its pin holes, or at every hole where it has none."""
    seat = RigidTransform.from_translation([0.0, 0.0, thickness_m])
    offsets_mm = {
        hole.name: float(np.linalg.norm((M_T_D.apply(hole.position_m) - hole.position_m)[:2])) / MM
        for hole in pin_holes(holes) or holes
    }
    return SeatError(assembly_error(seat, M_T_D), offsets_mm)
