"""Bodies of a model at every taught pose: the first one solid, the others as ghosts."""

from collections.abc import Iterator
from dataclasses import dataclass

import trimesh

from cellctl.planning.scene.cell_scene import CellScene
from cellctl.planning.scene.solid import Solid


@dataclass(frozen=True, slots=True, eq=False)
class DrawnBody:
    """One body at one pose."""

    name: str
    solid: Solid
    mesh: trimesh.Trimesh
    """The body in the frame of the cell, in m."""
    ghost: bool


def drawn_bodies(scene: CellScene) -> Iterator[DrawnBody]:
    """Fixtures, then each arm at each of its taught poses; what an arm does not move once."""
    for solid in scene.solids:
        if solid.arm is None:
            mesh = solid.shape.mesh().copy().apply_transform(solid.link_T_shape)
            yield DrawnBody(solid.name, solid, mesh, ghost=False)
    for name, arm in scene.arms.items():
        for number, pose in enumerate(arm.config.poses_deg):
            for solid, matrix in scene.placed({name: arm.taught_rad(pose)}):
                # The base of an arm is in the same place at every pose: drawn once, or its ghosts
                # would cover it.
                if solid.arm == name and not (solid.still and number):
                    mesh = solid.shape.mesh().copy().apply_transform(matrix)
                    yield DrawnBody(f"{solid.name} at {pose}", solid, mesh, ghost=number > 0)
