"""The devices of a deck-to-frame cell by their roles, so that steps read like the paper."""

from dataclasses import dataclass
from typing import cast

from scipy.spatial.transform import RigidTransform

from cellctl.cell.devices import Cell
from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.cell.stereo_station import StereoStation
from cellctl.config.cell import CellConfig
from cellctl.config.devices import ForceSensorConfig, RobotConfig
from cellctl.guard.client import GuardClient
from cellctl.interfaces import Robot, TargetTracker
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.roles import FORCE, HEAD_1, HEAD_2, ROLES, TRACKER
from cellctl.processes.deck_to_frame.settings import DeckSettings
from cellctl.workers import VisionWorkers


@dataclass(slots=True)
class FrameMemory:
    """What the last run knew of the station: only for leaving it straight and no harder than its
    recipe allows."""

    base_T_frame: RigidTransform | None = None
    """The frame as it was measured last."""
    recipe_id: int | None = None
    """Whose deck the arm has carried since; None after a restart."""


@dataclass(frozen=True, slots=True)
class DeckCell:
    """The roles of one recipe, taken by devices of the cell."""

    cell: Cell
    arm: GuardedRobot
    """The main robot, which carries the deck, with force sensor and guard."""
    head_1: StereoStation
    head_2: StereoStation
    tracker: TargetTracker
    settings: DeckSettings
    recipes: tuple[DeckRecipe, ...]
    """All recipes that use these devices: any of their decks may stand over the station."""
    memory: FrameMemory

    @classmethod
    def of(cls, cell: Cell, recipe: DeckRecipe, memory: FrameMemory) -> "DeckCell":
        """Roles as the recipe binds them; the check of the cell file saw to it that all exist."""
        return cls(
            cell,
            cell.guarded_robot(recipe.device(FORCE)),
            cell.stereo_station(recipe.device(HEAD_1)),
            cell.stereo_station(recipe.device(HEAD_2)),
            cell.trackers[recipe.device(TRACKER)],
            cast(DeckSettings, cell.config.processes[recipe.process]),
            tuple(other for other in deck_recipes(cell.config) if _same_devices(recipe, other)),
            memory,
        )

    @property
    def heads(self) -> tuple[StereoStation, StereoStation]:
        """Head I and head II."""
        return self.head_1, self.head_2

    def head(self, role: str) -> StereoStation:
        """The head in one of the two roles."""
        return {HEAD_1: self.head_1, HEAD_2: self.head_2}[role]

    @property
    def main(self) -> Robot:
        """The robot that carries the deck."""
        return self.arm.robot

    @property
    def main_config(self) -> RobotConfig:
        """Section of that robot in the cell file."""
        return self.arm.config

    @property
    def guard(self) -> GuardClient:
        """The guard of the force sensor between flange and deck."""
        return self.arm.guard

    @property
    def force_config(self) -> ForceSensorConfig:
        """Section of that sensor in the cell file."""
        return self.arm.sensor

    @property
    def workers(self) -> VisionWorkers:
        """The vision workers, for images and long solves."""
        return self.cell.workers


def deck_recipes(config: CellConfig) -> tuple[DeckRecipe, ...]:
    """The recipes of this process."""
    return tuple(recipe for recipe in config.recipes if isinstance(recipe, DeckRecipe))


def _same_devices(one: DeckRecipe, other: DeckRecipe) -> bool:
    return all(one.device(role) == other.device(role) for role in ROLES)
