"""How far a seated deck is from its seat."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.coverage import COVERAGE_FACTOR
from cellctl.geometry.pose import MM, Array
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.deck_to_frame.poses.pose_correction import assembly_error
from cellctl.vision.features.hole import Hole
from cellctl.vision.registration.rigid_fit import by_pose


@dataclass(frozen=True, slots=True, eq=False)
class SeatError:
    """A seated deck as the cameras saw it."""

    error: Array
    """Seat minus measured, shape (6,): x, y, z in m and rx, ry, rz in rad, in the axes of M."""
    covariance: Array
    """Covariance of the measured deck in the frame, shape (6, 6), in the order of
    ``UncertainPose``."""
    offsets_mm: Mapping[str, float]
    """Lateral distance of each judged hole from its place, by the name of the hole."""
    offset_uncertainties_mm: Mapping[str, float]
    """Expanded uncertainty of each offset."""

    @property
    def gap_mm(self) -> float:
        """Distance between deck and frame in the middle of the face; positive when the deck stands
        off."""
        # The error is seat minus measured, so a deck that stands too high has a negative z.
        return -float(self.error[2]) / MM

    @property
    def gap_uncertainty_mm(self) -> float:
        """Expanded uncertainty of the gap."""
        return COVERAGE_FACTOR * float(np.sqrt(self.covariance[2, 2])) / MM

    def rotations(self, limits_deg: Sequence[float]) -> tuple["SeatRotation", ...]:
        """About x, y and z of the frame, each with its limit."""
        found_deg = np.degrees(np.abs(self.error[3:])).tolist()
        uncertainty_deg = COVERAGE_FACTOR * np.degrees(np.sqrt(np.diag(self.covariance)[3:]))
        columns = zip("xyz", found_deg, uncertainty_deg.tolist(), limits_deg, strict=True)
        return tuple(SeatRotation(*values) for values in columns)

    def rotation(self, limits_deg: Sequence[float]) -> "SeatRotation":
        """About the axis with the least room to its limit; limits about x, y and z of the frame."""
        all_three = self.rotations(limits_deg)
        room_deg = [one.acceptance_deg - one.value_deg for one in all_three]
        # A rotation that is not a number has the least room of all: argmin finds it first.
        return all_three[int(np.argmin(room_deg))]


@dataclass(frozen=True, slots=True)
class SeatRotation:
    """Rotation of a seated deck about one axis of the frame, in degrees."""

    axis: str
    value_deg: float
    uncertainty_deg: float
    """Expanded uncertainty of the rotation."""
    limit_deg: float

    @property
    def acceptance_deg(self) -> float:
        """Greatest measured rotation that is surely within its limit."""
        return self.limit_deg - self.uncertainty_deg


def pin_holes(holes: Sequence[Hole]) -> list[Hole]:
    """The holes that a pin enters and that a person can gauge."""
    return [hole for hole in holes if hole.kind == "pin"]


def judged_holes(holes: Sequence[Hole]) -> Sequence[Hole]:
    """At which the lateral offset of a seated deck is judged: every hole, where it has no pins."""
    return pin_holes(holes) or holes


def seat_error(M_T_D: UncertainPose, thickness_m: float, holes: Sequence[Hole]) -> SeatError:
    """Error of a seated deck, judged at its pin holes, or at every hole where it has none."""
    seat = RigidTransform.from_translation([0.0, 0.0, thickness_m])
    judged = judged_holes(holes)
    offsets_mm = {
        hole.name: float(np.linalg.norm(_moved(M_T_D.pose, hole)[:2])) / MM for hole in judged
    }
    uncertainties_mm = {hole.name: _lateral_uncertainty_mm(M_T_D, hole) for hole in judged}
    error = assembly_error(seat, M_T_D.pose)
    return SeatError(error, M_T_D.covariance, offsets_mm, uncertainties_mm)


def _moved(M_T_D: RigidTransform, hole: Hole) -> Array:
    """Vector from the nominal place of a hole to its measured place, shape (3,)."""
    return np.asarray(M_T_D.apply(hole.position_m) - hole.position_m)


def _lateral_uncertainty_mm(M_T_D: UncertainPose, hole: Hole) -> float:
    """Uncertainty of the lateral offset in the direction in which it is greatest: the direction of
    a small offset is not known."""
    turned_m = M_T_D.pose.rotation.apply(hole.position_m)
    design = by_pose(turned_m[None])[0, :2]
    variance = np.linalg.eigvalsh(design @ M_T_D.covariance @ design.T).max()
    return COVERAGE_FACTOR * float(np.sqrt(variance)) / MM
