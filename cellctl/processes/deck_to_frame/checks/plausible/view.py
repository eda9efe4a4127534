"""One head over the two parts of a recipe."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.issue import WrittenValue
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.deck_to_frame.checks.plausible.sight import (
    Optics,
    PartInPlace,
    base_T_carrier,
    flange_at,
)
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.record_names import BOARD_TRANSFER_NAME
from cellctl.processes.deck_to_frame.roles import DECK_MEASURE, MAIN, MEASURING


@dataclass(frozen=True, slots=True, eq=False)
class HeadView:
    """One head over both parts."""

    cell: CellConfig
    recipe: DeckRecipe
    key: str
    role: str
    parts: tuple[PartInPlace, ...]
    optics: Optics
    bases: Mapping[str, Sequence[float]]

    @property
    def head(self) -> str:
        """Its name in the cell file."""
        return self.recipe.device(self.role)

    @property
    def carrier(self) -> str:
        """The robot that carries it."""
        return self.cell.stereo_cameras[self.head].carried_by or ""

    def camera(
        self, carrier: str, pose: str, flange_T_camera: Sequence[float] | None = None
    ) -> RigidTransform | None:
        """``base_T_camera`` by the model, with the head on an arm at one of its taught poses."""
        base = base_T_carrier(self.recipe, self.bases, carrier)
        written = flange_T_camera or self.cell.stereo_cameras[self.head].flange_T_camera
        joints_deg = self.cell.robots[carrier].poses_deg.get(pose)
        if base is None or written is None or joints_deg is None:
            return None
        flange = flange_at(self.cell, carrier, joints_deg)
        return None if flange is None else base * flange * pose_from_xyzabc(written)

    def mounted_mm_deg(self) -> tuple[float, ...]:
        """``flange_T_camera`` as it is written; empty where it is not."""
        return self.cell.stereo_cameras[self.head].flange_T_camera or ()

    def mounting(self) -> WrittenValue:
        """The key that says how the head is mounted."""
        key = f"stereo_cameras.{self.head}.flange_T_camera"
        return WrittenValue(key, str(list(self.mounted_mm_deg())))

    def by_model(self) -> WrittenValue:
        """What says where the base of the arm stands."""
        written = str(list(self.bases.get(self.carrier, ())))
        return WrittenValue(f"the model of the cell, cell_T_base of {self.carrier}", written)

    def by_transfer(self) -> WrittenValue:
        """What was measured of the camera's place."""
        return WrittenValue(f"the stored {BOARD_TRANSFER_NAME}", f"the place of {self.head}")

    def camera_from(self) -> tuple[WrittenValue, ...]:
        """What the place of the camera follows from where it was not measured."""
        measuring = self._taught(self.carrier, MEASURING)
        return (measuring, self.mounting(), self.by_model(), self.kinematics(self.carrier))

    def frame_from(self) -> tuple[WrittenValue, ...]:
        """What the place of the frame follows from."""
        written = str(list(self.recipe.base_T_frame))
        return (WrittenValue(f"{self.key}.base_T_frame", written),)

    def deck_from(self) -> tuple[WrittenValue, ...]:
        """What the place of the deck follows from while it is measured."""
        deck = WrittenValue(f"{self.key}.flange_T_deck", str(list(self.recipe.flange_T_deck)))
        main = self.recipe.device(MAIN)
        return (self._taught(main, DECK_MEASURE), deck, self.kinematics(main))

    def kinematics(self, robot: str) -> WrittenValue:
        """What says where the flange of an arm is at its joints."""
        return WrittenValue(f"robots.{robot}.settings", "the kinematics of the arm")

    def _taught(self, robot: str, pose: str) -> WrittenValue:
        joints = str(list(self.cell.robots[robot].poses_deg[pose]))
        return WrittenValue(f"robots.{robot}.poses_deg.{pose}", joints)

    def unseen(self, camera: RigidTransform) -> dict[str, list[str]]:
        """Holes that the head is to see and does not, by part."""
        return {
            part.drawing.part: self.optics.unseen(camera, part, part.holes_of(self.role))
            for part in self.parts
        }

    def sees(self, camera: RigidTransform | None) -> bool:
        """Whether all holes of the head are in its picture."""
        return camera is not None and not any(self.unseen(camera).values())
