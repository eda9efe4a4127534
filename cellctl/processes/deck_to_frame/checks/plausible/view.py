"""One head over the two parts of a recipe."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.deck_to_frame.checks.plausible.sight import (
    Optics,
    PartInPlace,
    base_T_carrier,
    flange_at,
)
from cellctl.processes.deck_to_frame.recipe import DeckRecipe


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

    def unseen(self, camera: RigidTransform) -> dict[str, list[str]]:
        """Holes that the head is to see and does not, by part."""
        return {
            part.drawing.part: self.optics.unseen(camera, part, part.holes_of(self.role))
            for part in self.parts
        }

    def sees(self, camera: RigidTransform | None) -> bool:
        """Whether all holes of the head are in its picture."""
        return camera is not None and not any(self.unseen(camera).values())
