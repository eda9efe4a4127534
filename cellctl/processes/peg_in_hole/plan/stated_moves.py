"""Every move that this process can command, for planning offline.

Motions by touch follow a stream whose places depend on what is felt. Stated are straight moves that
bound them: from over the hole to the circle on which the face is touched, round it, and down to the
seat. Whoever adds a move to the process adds it here.
"""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.stated.arm_places import ArmPlaces
from cellctl.config.stated.moves import MoveKind, StatedMove, StatedPlace
from cellctl.geometry.pose import MM, Array, pose_from_xyzabc
from cellctl.processes.peg_in_hole.leaving import CLEAR_OF_FACE_M
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.roles import ABOVE_HOLE, FORCE, HOME
from cellctl.processes.peg_in_hole.search.face import ANGLES_RAD, CLEAR_M


def peg_moves(cell: CellConfig, recipe: PegRecipe) -> Iterator[StatedMove]:
    """Of a run, of the way home from wherever it may have ended, and of procedures 301 and 302,
    which begin and end as a run does and touch the same face.

    Raises ``ArmNotDescribed``.
    """
    arm = cell.force_sensors[recipe.device(FORCE)].mounted_on
    places = _TipPlaces(cell, recipe, arm)
    home, above = places.taught(HOME), places.taught(ABOVE_HOLE)
    yield StatedMove(arm, MoveKind.JOINT, home, above)
    yield StatedMove(arm, MoveKind.JOINT, above, home)
    radius_m = recipe.base_T_hole.face_radius_mm * MM
    circle = [radius_m * np.array([np.cos(angle), np.sin(angle)]) for angle in ANGLES_RAD]
    over = [
        places.at(f"over touch {number}", place_m, places.clear_m)
        for number, place_m in enumerate(circle, start=1)
    ]
    for start, end in pairwise([above, *over]):
        yield StatedMove(arm, MoveKind.LINEAR, start, end, approach=True)
    lowest = [
        places.at(f"touch {number}", place_m, -places.face_m)
        for number, place_m in enumerate(circle, start=1)
    ]
    seat = places.at("seat", np.zeros(2), -places.seat_m)
    middle = places.at("over the hole", np.zeros(2), places.clear_m)
    yield StatedMove(arm, MoveKind.LINEAR, over[-1], middle, approach=True)
    for high, low in zip([*over, middle], [*lowest, seat], strict=True):
        yield StatedMove(arm, MoveKind.LINEAR, high, low, approach=True)
        yield from _way_home(arm, places, low, home)


def _way_home(
    arm: str, places: "_TipPlaces", low: StatedPlace, home: StatedPlace
) -> Iterator[StatedMove]:
    """Straight out of the hole or off the face, then home."""
    lifted = places.lifted(low)
    yield StatedMove(arm, MoveKind.LINEAR, low, lifted, approach=True)
    yield StatedMove(arm, MoveKind.JOINT, lifted, home)


class _TipPlaces:
    """Places of the tip about the believed hole, in the attitude of the taught pose over it."""

    def __init__(self, cell: CellConfig, recipe: PegRecipe, arm: str) -> None:
        self._arm = ArmPlaces(cell, arm)
        self._hole = pose_from_xyzabc(recipe.base_T_hole.pose)
        self._flange_T_tip = pose_from_xyzabc(recipe.flange_T_tip)
        above = self.taught(ABOVE_HOLE)
        self._above_rad = above.joints_rad
        tip = self._hole.inv() * self._arm.flange_at(above) * self._flange_T_tip
        self._attitude = tip.rotation
        uncertain_m = recipe.base_T_hole.height_uncertainty_mm * MM
        self.clear_m = CLEAR_M + uncertain_m
        """Height over the believed face at which the tip may go sideways."""
        self.face_m = recipe.base_T_hole.datum_depth_mm * MM + uncertain_m
        """Depth below the believed face down to which a touch may go."""
        self.seat_m = recipe.fit.depth_mm * MM + uncertain_m
        self._lift_m = CLEAR_OF_FACE_M + uncertain_m

    def taught(self, pose: str) -> StatedPlace:
        """A taught pose."""
        return self._arm.taught(pose)

    def at(self, label: str, place_m: Array, height_m: float) -> StatedPlace:
        """The tip beside the middle of the hole by (x, y) and so high over its face."""
        tip = RigidTransform.from_components([*place_m, height_m], self._attitude)
        base_T_flange = self._hole * tip * self._flange_T_tip.inv()
        return StatedPlace(label, self._above_rad, base_T_flange)

    def lifted(self, low: StatedPlace) -> StatedPlace:
        """Up along the axis of the hole until the tip is clear of the face."""
        assert low.base_T_flange is not None, "only taught places have none"
        tip = self._hole.inv() * low.base_T_flange * self._flange_T_tip
        x_m, y_m, _ = tip.translation
        return self.at(f"clear of the {low.label}", np.array([x_m, y_m]), self._lift_m)
