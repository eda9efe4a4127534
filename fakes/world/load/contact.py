"""Where a body that hangs from a robot can touch another one that stands still."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.world.frames import Array
from fakes.world.load.suspension import Contacts, Flags, Wedges

OUT_OF_REACH_M = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class ContactPoints:
    """Places in the frame of the body that hangs; directions and anchors in that of the other."""

    points_m: Array
    directions: Array
    anchors_m: Array
    stiffness_n_m: Array
    half_size_m: Array
    """Farther aside than this, the body is not over the other one."""
    wedges: Wedges
    """Shape (m, d, 3): rows that bound an obstacle in each direction around it, its top last."""
    ahead: Flags
    """Shape (n,): rows that are met along the approach. Beside a pin its wall is always near."""
    holding: Flags
    """Shape (n,): rows that pull as well, once they were closed."""

    def gaps(self, other_T_body: Array) -> Array:
        """Distance of each point to what it can touch, shape (n,); ``other_T_body`` is 4x4."""
        places = self.points_m @ other_T_body[:3, :3].T + other_T_body[:3, 3]
        over = np.abs(other_T_body[:2, 3]) < self.half_size_m
        if not over.all():
            return np.full(len(places), OUT_OF_REACH_M)
        return np.asarray(((places - self.anchors_m) * self.directions).sum(axis=1))

    def distance(self, gaps: Array) -> float:
        """Height above whatever is met first."""
        return float(gaps[self.ahead].min())

    def contacts(self, com_T_body: RigidTransform, damping_ratio: float, mass: float) -> Contacts:
        """The same points as seen from the centre of mass, in tool axes."""
        places = com_T_body.apply(self.points_m)
        directions = com_T_body.rotation.apply(self.directions)
        jacobian = np.hstack([directions, np.cross(places, directions)])
        stiffness = self.stiffness_n_m
        # Rows that carry are closed together and damp as one spring of their sum; of a wedge
        # one face pushes at a time, and damps by its own stiffness.
        together = stiffness.copy()
        carrying = np.ones(len(stiffness), dtype=bool)
        carrying[self.wedges] = False
        together[carrying] = stiffness[carrying].sum()
        damping = 2 * damping_ratio * np.sqrt(mass / together) * stiffness
        holding = self.holding if self.holding.any() else None
        return Contacts(jacobian, stiffness, damping, self.wedges, holding)


@dataclass(frozen=True, slots=True)
class Touch:
    """What a body that hangs from a flange can touch, and how."""

    flange_T_body: RigidTransform
    cell_T_other: RigidTransform
    points: ContactPoints
    damping_ratio: float
    friction: float
