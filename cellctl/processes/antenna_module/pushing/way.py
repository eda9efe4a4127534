"""The straight way of a plug into its socket, by depth."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array


@dataclass(frozen=True, slots=True, eq=False)
class InsertionWay:
    """Depth is 0 where tips and face first touch, and grows into the socket."""

    seated: RigidTransform
    """``base_T_flange`` with the plug seated, as planned."""
    outwards: Array
    """Unit vector out of the socket in the base, shape (3,)."""
    seat_depth_m: float

    @classmethod
    def of(
        cls, seated: RigidTransform, flange_T_plug: RigidTransform, seat_depth_m: float
    ) -> "InsertionWay":
        """The way of a plan; ``flange_T_plug`` is the chain's, with z out of the socket."""
        outwards = (seated * flange_T_plug).rotation.apply([0.0, 0.0, 1.0])
        return cls(seated, np.asarray(outwards), seat_depth_m)

    def pose_at(self, depth_m: float) -> RigidTransform:
        """``base_T_flange`` with the plug so deep."""
        back_m = self.seat_depth_m - depth_m
        return RigidTransform.from_translation(self.outwards * back_m) * self.seated

    def depth_of(self, base_T_flange: RigidTransform) -> float:
        """How deep the plug is, as the flange says: what arm and fingers give way is not in it."""
        back_m = self.outwards @ (base_T_flange.translation - self.seated.translation)
        return float(self.seat_depth_m - back_m)

    def outwards_from(self, base_T_flange: RigidTransform, way_m: float) -> RigidTransform:
        """The flange moved out of the socket by ``way_m`` from where it is, wherever a stop has
        left it."""
        return RigidTransform.from_translation(self.outwards * way_m) * base_T_flange
