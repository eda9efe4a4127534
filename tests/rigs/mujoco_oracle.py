"""Distances between the bodies of a model by MuJoCo, an independent second opinion."""

from collections.abc import Mapping
from itertools import combinations

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.geometry.pose import Array
from cellctl.planning.model.shapes import BoxShape, CapsuleShape
from cellctl.planning.scene.cell_scene import CellScene
from cellctl.planning.scene.solid import Solid

FAR_M = 20.0


class MujocoOracle:
    """Bodies are geoms of mocap bodies, placed by the poses of the links and nothing else."""

    def __init__(self, scene: CellScene) -> None:
        self._scene = scene
        spec = mujoco.MjSpec()
        for solid in scene.solids:
            body = spec.worldbody.add_body(name=solid.name, mocap=True)
            body.add_geom(name=solid.name, **_geom(solid))
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        self._ids = {solid.name: self._model.geom(solid.name).id for solid in scene.solids}
        self._pairs_of: dict[str, list[tuple[Solid, Solid]]] = {}

    def narrowest_slack_m(
        self, robot: str, joints_rad: Mapping[str, Array], *, approach: bool = False
    ) -> float:
        """The least slack of all pairs in which one arm takes part, with every arm at joints."""
        placed = self._scene.placed(joints_rad)
        for solid, pose in placed:
            index = self._model.body(solid.name).mocapid[0]
            self._data.mocap_pos[index] = pose[:3, 3]
            quaternion = Rotation.from_matrix(pose[:3, :3]).as_quat(scalar_first=True)
            self._data.mocap_quat[index] = quaternion
        mujoco.mj_kinematics(self._model, self._data)
        at = {solid.name: pose[:3, 3] for solid, pose in placed}
        best_m = np.inf
        for first, second in self._pairs(robot):
            if first.name in at and second.name in at:
                apart_m = float(np.linalg.norm(at[first.name] - at[second.name]))
                required_m = self._required_m(first, second, approach=approach)
                balls_m = first.shape.radius_m + second.shape.radius_m
                # The balls around two bodies are never nearer than the bodies.
                if apart_m - balls_m - required_m < best_m:
                    best_m = min(best_m, self._distance_m(first, second) - required_m)
        return best_m

    def _pairs(self, robot: str) -> list[tuple[Solid, Solid]]:
        if robot not in self._pairs_of:
            solids = self._scene.solids
            self._pairs_of[robot] = [
                (first, second)
                for first, second in combinations(solids, 2)
                if robot in (first.arm, second.arm) and self._may_meet(first, second)
            ]
        return self._pairs_of[robot]

    def _distance_m(self, first: Solid, second: Solid) -> float:
        ids = self._ids[first.name], self._ids[second.name]
        found_m = mujoco.mj_geomDistance(self._model, self._data, *ids, FAR_M, np.zeros(6))
        # How deep is not compared; but bodies that meet must not pass where no margin is asked for.
        return max(-1e-9, float(found_m))

    def _required_m(self, first: Solid, second: Solid, *, approach: bool) -> float:
        pair = frozenset((first.name, second.name))
        if approach and pair in self._scene.approaches:
            return self._scene.approaches[pair]
        return 0.0 if first.arm == second.arm else first.margin_m + second.margin_m

    def _may_meet(self, first: Solid, second: Solid) -> bool:
        if first.still and second.still:
            return False
        if first.arm != second.arm:
            return True
        links = sorted({solid.link for solid in self._scene.solids if solid.arm == first.arm})
        return abs(links.index(first.link) - links.index(second.link)) > 1


def _geom(solid: Solid) -> dict[str, object]:
    shape = solid.shape
    if isinstance(shape, CapsuleShape):
        size = [shape.ball_m, shape.length_m / 2, 0.0]
        return {"type": mujoco.mjtGeom.mjGEOM_CAPSULE, "size": size}
    assert isinstance(shape, BoxShape)
    return {"type": mujoco.mjtGeom.mjGEOM_BOX, "size": [side / 2 for side in shape.size_m]}
