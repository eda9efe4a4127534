"""Random cells: the shipped one with displaced frame and heads, a deck size and obstacles."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.config import load_cell
from cellctl.config.model_file import model_path
from cellctl.geometry.pose import Array
from cellctl.planning.model.read import read_model
from cellctl.planning.model.shapes import BoxShape
from cellctl.planning.scene.cell_scene import CellScene
from cellctl.planning.scene.solid import Solid

CELL_FILE = Path("config/deck.toml")
GREATEST_SHIFT_M = 0.3
DECKS_M = ((1.0, 0.5, 0.015), (0.6, 0.4, 0.015))
MOST_OBSTACLES = 3
_OBSTACLES_FROM_M, _OBSTACLES_TO_M = np.array([0.7, -1.5, 0.3]), np.array([2.4, 1.5, 2.2])


@dataclass(frozen=True, slots=True, eq=False)
class RandomCell:
    """One cell with what was drawn."""

    scene: CellScene
    heads_shift_m: Mapping[str, Array]
    obstacles: int


def random_cell(seed: int) -> RandomCell:
    """The bases of the arms that carry the heads, and the frame with its station, are displaced by
    up to 300 mm along x and y. Taught joints stay, so the ends of some ways are not free."""
    rng = np.random.default_rng(seed)
    scene = read_model(load_cell(CELL_FILE), model_path(CELL_FILE))
    heads = {name: _shift(rng) for name in scene.arms if name != "main"}
    frame_m = _shift(rng)
    deck_m = DECKS_M[int(rng.integers(len(DECKS_M)))]
    solids = [_changed(solid, frame_m, deck_m) for solid in scene.solids]
    count = int(rng.integers(MOST_OBSTACLES + 1))
    solids += [_obstacle(rng, number) for number in range(count)]
    arms = {
        name: replace(
            arm, cell_T_base=RigidTransform.from_translation(heads[name]) * arm.cell_T_base
        )
        if name in heads
        else arm
        for name, arm in scene.arms.items()
    }
    return RandomCell(replace(scene, arms=arms, solids=tuple(solids)), heads, count)


def _shift(rng: np.random.Generator) -> Array:
    return np.append(rng.uniform(-GREATEST_SHIFT_M, GREATEST_SHIFT_M, 2), 0.0)


def _changed(solid: Solid, frame_m: Array, deck_m: tuple[float, float, float]) -> Solid:
    if solid.name in ("frame", "station"):
        pose = solid.link_T_shape.copy()
        pose[:3, 3] += frame_m
        return replace(solid, link_T_shape=pose)
    if solid.name == "main.deck":
        return replace(solid, shape=BoxShape(deck_m))
    return solid


def _obstacle(rng: np.random.Generator, number: int) -> Solid:
    pose = RigidTransform.from_components(
        rng.uniform(_OBSTACLES_FROM_M, _OBSTACLES_TO_M), Rotation.random(rng=rng)
    ).as_matrix()
    sides = rng.uniform(0.1, 0.4, 3).tolist()
    shape = BoxShape((sides[0], sides[1], sides[2]))
    return Solid(f"obstacle_{number}", None, 0, pose, shape, 0.0, stand_in=False)
