"""Whether anything stands between a head and the holes that it looks at."""

from collections.abc import Mapping

import fcl
import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array
from cellctl.planning.model.shapes import CapsuleShape
from cellctl.planning.scene.cell_scene import CellScene
from cellctl.planning.scene.solid import Solid
from cellctl.planning.views.looks import left_T_middle
from cellctl.planning.views.seeing import SeenHoles, sunk_m
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.camera.stereo_projection import right_camera_m

_ABOVE_FACE_M = 0.002
"""Where a line of sight begins, beside the radius of its rim: the part itself is no obstacle."""


class Sights:
    """Everything that may hide a hole, with the arms at given joints."""

    def __init__(self, scene: CellScene, joints_rad: Mapping[str, Array], carrier: str) -> None:
        """``carrier``: the arm that carries the head; what hangs on its flange is the head."""
        self._bodies = [
            (solid, _object(solid, pose))
            for solid, pose in scene.placed(joints_rad)
            if not (solid.arm == carrier and solid.link == 6)
        ]

    def hidden_by(
        self, head: StereoHead, cell_T_left: RigidTransform, seen: SeenHoles
    ) -> str | None:
        """The body that hides a hole from a camera, or keeps the light of the lamp from it."""
        right_m = right_camera_m(head)
        ends_m = cell_T_left.apply([np.zeros(3), right_m, left_T_middle(head).translation])
        for hole, place_m in zip(seen.holes, seen.places_m, strict=True):
            # A rim below the face: the line of sight begins at the face.
            radius_m = (hole.countersink_m or hole.diameter_m) / 2
            start_m = place_m + (sunk_m(hole) + radius_m + _ABOVE_FACE_M) * seen.outward
            for end_m in ends_m:
                line = _line(start_m, end_m, radius_m)
                for solid, body in self._bodies:
                    if fcl.collide(line, body, fcl.CollisionRequest(), fcl.CollisionResult()):
                        return f"{solid.name} hides {hole.name}"
        return None


def _object(solid: Solid, pose: Array) -> fcl.CollisionObject:
    return fcl.CollisionObject(solid.shape.geometry(), fcl.Transform(pose[:3, :3], pose[:3, 3]))


def _line(start_m: Array, end_m: Array, radius_m: float) -> fcl.CollisionObject:
    way_m = end_m - start_m
    length_m = float(np.linalg.norm(way_m))
    z = way_m / length_m
    x = np.cross(z, [1.0, 0.0, 0.0] if abs(z[0]) < 0.9 else [0.0, 1.0, 0.0])
    x /= np.linalg.norm(x)
    turn = np.column_stack([x, np.cross(z, x), z])
    shape = CapsuleShape(radius_m, length_m)
    middle_m = (start_m + end_m) / 2
    return fcl.CollisionObject(shape.geometry(), fcl.Transform(turn, middle_m))
