"""The arms of a deck's recipe by what they do, and places where they may stand."""

from dataclasses import dataclass

from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.stated.arm_places import ArmPlaces
from cellctl.config.stated.moves import StatedPlace
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.roles import (
    DECK_MEASURE,
    FORCE,
    HEAD_1,
    HEAD_2,
)

Others = dict[str, tuple[StatedPlace, ...]]


@dataclass(frozen=True, slots=True)
class ArmsInRoles:
    """The arms of a recipe, and where they stand."""

    cell: CellConfig
    recipe: DeckRecipe

    @property
    def main(self) -> str:
        """The arm that carries the deck."""
        return self.cell.force_sensors[self.recipe.device(FORCE)].mounted_on

    @property
    def heads(self) -> dict[str, str]:
        """The arm that carries each head, by the name of the head."""
        names = self.recipe.device(HEAD_1), self.recipe.device(HEAD_2)
        # The check of the cell file saw to it that an arm carries them.
        return {name: self.cell.stereo_cameras[name].carried_by or "" for name in names}

    def taught(self, robot: str, pose: str) -> StatedPlace:
        """A taught pose."""
        return ArmPlaces(self.cell, robot).taught(pose)

    def at_flange(
        self, label: str, base_T_flange: RigidTransform, near: StatedPlace
    ) -> StatedPlace:
        """A place of the flange, with the arm folded as at another place."""
        return StatedPlace(label, near.joints_rad, base_T_flange)

    def flange_at(self, robot: str, place: StatedPlace) -> RigidTransform:
        """``base_T_flange`` at a place; raises ``ArmNotDescribed``."""
        return ArmPlaces(self.cell, robot).flange_at(place)

    def heads_at(self, *poses: str) -> Others:
        """Both heads' arms, each at any of these poses."""
        return {
            robot: tuple(self.taught(robot, pose) for pose in poses)
            for robot in self.heads.values()
        }

    def frame_at(self, label: str, height_mm: float) -> StatedPlace:
        """The deck so high over the mating face of the frame, its own thickness included."""
        recipe = self.recipe
        M_T_D = RigidTransform.from_translation([0.0, 0.0, height_mm * MM])
        base_T_flange = (
            pose_from_xyzabc(recipe.base_T_frame)
            * M_T_D
            * pose_from_xyzabc(recipe.flange_T_deck).inv()
        )
        return self.at_flange(label, base_T_flange, self.taught(self.main, DECK_MEASURE))
