"""Random cells: the shipped one with displaced frame and heads, a deck size and obstacles."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.config import load_cell
from cellctl.config.model_file import model_path
from cellctl.config.stated.moves import StatedPlace
from cellctl.geometry.pose import MM, Array
from cellctl.planning.model.read import read_model
from cellctl.planning.model.shapes import BoxShape
from cellctl.planning.scene.arm import PlannedArm
from cellctl.planning.scene.cell_scene import CellScene
from cellctl.planning.scene.solid import Solid
from cellctl.planning.ways.polyline import joints_at
from cellctl.processes.deck_to_frame.recipe import DeckRecipe

CELL_FILE = Path("config/deck.toml")
GREATEST_SHIFT_M = 0.3
DECKS_M = ((1.0, 0.5, 0.015), (0.6, 0.4, 0.015))
MOST_OBSTACLES = 3
_OBSTACLES_FROM_M, _OBSTACLES_TO_M = np.array([0.7, -1.5, 0.3]), np.array([2.4, 1.5, 2.2])


_OVER_STATION = {"main": "deck_measure", "aux_1": "measuring", "aux_2": "measuring"}
"""The taught pose of each arm that goes with the frame."""


@dataclass(frozen=True, slots=True, eq=False)
class RandomCell:
    """What was drawn; ``scene`` makes the cell of it."""

    frame_shift_m: Array
    """Shape (3,), of frame and station."""
    heads_shift_m: Mapping[str, Array]
    """Shifts of the bases of the arms that carry the heads, each of shape (3,)."""
    deck_m: tuple[float, float, float]
    obstacles: tuple[Solid, ...]

    def scene(self, follow: Collection[str] = ("main", "aux_1", "aux_2")) -> CellScene:
        """The shipped cell so changed, the poses over the station of arms that ``follow`` taught
        again.

        Raises ``PlaceUnreachable`` where an arm does not reach such a pose.
        """
        scene = read_model(load_cell(CELL_FILE), model_path(CELL_FILE), CELL_FILE.parent)
        arms = {name: self._arm(arm, follow=name in follow) for name, arm in scene.arms.items()}
        solids = (*(self._changed(solid) for solid in scene.solids), *self.obstacles)
        recipes = tuple(self._recipe(cast(DeckRecipe, one)) for one in scene.cell.recipes)
        # Zones are drawn for one place of the station. Bodies keep the arms apart here.
        cell = scene.cell.model_copy(update={"recipes": recipes, "zones": {}})
        return replace(scene, cell=cell, solids=solids).with_arms(arms)

    def _recipe(self, recipe: DeckRecipe) -> DeckRecipe:
        # The base of the main arm is the origin of the cell, and its axes are those of the cell.
        x, y, z, *turn = recipe.base_T_frame
        dx, dy, dz = (self.frame_shift_m / MM).tolist()
        return recipe.model_copy(update={"base_T_frame": (x + dx, y + dy, z + dz, *turn)})

    def _arm(self, arm: PlannedArm, *, follow: bool) -> PlannedArm:
        shift = RigidTransform.from_translation(self.heads_shift_m.get(arm.name, np.zeros(3)))
        moved = replace(arm, cell_T_base=shift * arm.cell_T_base)
        if not follow:
            return moved
        pose = _OVER_STATION[arm.name]
        taught_rad = arm.taught_rad(pose)
        cell_T_flange = arm.cell_T_base * arm.base_T_flange(taught_rad)
        with_frame = RigidTransform.from_translation(self.frame_shift_m)
        base_T_flange = moved.cell_T_base.inv() * with_frame * cell_T_flange
        found_rad = joints_at(moved, StatedPlace(pose, taught_rad, base_T_flange))
        return taught_at(moved, pose, found_rad)

    def _changed(self, solid: Solid) -> Solid:
        if solid.name in ("frame", "station"):
            pose = solid.link_T_shape.copy()
            pose[:3, 3] += self.frame_shift_m
            return replace(solid, link_T_shape=pose)
        if solid.name == "main.deck":
            return replace(solid, shape=BoxShape(self.deck_m))
        return solid


def taught_at(arm: PlannedArm, pose: str, joints_rad: Array) -> PlannedArm:
    """The arm with this pose taught anew."""
    poses_deg = {**arm.config.poses_deg, pose: tuple(np.degrees(joints_rad).tolist())}
    return replace(arm, config=arm.config.model_copy(update={"poses_deg": poses_deg}))


def random_cell(seed: int) -> RandomCell:
    """Frame and bases of the heads' arms displaced by up to 300 mm along x and y."""
    rng = np.random.default_rng(seed)
    heads = {name: _shift(rng) for name in ("aux_1", "aux_2")}
    frame_m = _shift(rng)
    deck_m = DECKS_M[int(rng.integers(len(DECKS_M)))]
    obstacles = [_obstacle(rng, number) for number in range(int(rng.integers(MOST_OBSTACLES + 1)))]
    return RandomCell(frame_m, heads, deck_m, tuple(obstacles))


def _shift(rng: np.random.Generator) -> Array:
    return np.append(rng.uniform(-GREATEST_SHIFT_M, GREATEST_SHIFT_M, 2), 0.0)


def _obstacle(rng: np.random.Generator, number: int) -> Solid:
    pose = RigidTransform.from_components(
        rng.uniform(_OBSTACLES_FROM_M, _OBSTACLES_TO_M), Rotation.random(rng=rng)
    ).as_matrix()
    sides = rng.uniform(0.1, 0.4, 3).tolist()
    shape = BoxShape((sides[0], sides[1], sides[2]))
    return Solid(f"obstacle_{number}", None, 0, pose, shape, 0.0, stand_in=False)
