"""Figures of a peg and its hole that do not go together."""

from collections.abc import Iterator

from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.checks.flange_places import flange_place_issues
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.roles import ARM
from cellctl.processes.peg_in_hole.stations import OVER


def plausible_issues(cell: CellConfig, recipe: PegRecipe, key: str) -> Iterator[ConfigIssue]:
    """A hole out of the arm's reach, and touches that meet the hole in place of the face."""
    base_T_hole = pose_from_xyzabc(recipe.base_T_hole.pose)
    tip_T_flange = pose_from_xyzabc(recipe.flange_T_tip).inv()
    places = {
        what: base_T_hole
        * RigidTransform.from_translation([0.0, 0.0, -depth_mm * MM])
        * RigidTransform.from_rotation(OVER)
        * tip_T_flange
        for what, depth_mm in (("at the face", 0.0), ("at the seat", recipe.fit.depth_mm))
    }
    written = f"{key}.base_T_hole.pose", str(list(recipe.base_T_hole.pose))
    yield from flange_place_issues(cell, recipe.device(ARM), written, places)
    yield from _touches(recipe, key)


def _touches(recipe: PegRecipe, key: str) -> Iterator[ConfigIssue]:
    """The foremost circle of the part, touching on a circle round the hole, must be beside it."""
    fit, place = recipe.fit, recipe.base_T_hole
    edge_mm = fit.peg_radius_mm + fit.clearance_mm + fit.hole_chamfer_mm
    if place.datum_depth_mm > 0.0 and fit.outer_radius_mm is not None:
        edge_mm = fit.outer_radius_mm
    least_mm = edge_mm + fit.peg_radius_mm - fit.peg_chamfer_mm
    if place.face_radius_mm < least_mm:
        allowed = (
            f"at least {least_mm:g}: a part of {fit.peg_radius_mm:g} mm radius that touches nearer "
            f"to the middle meets the edge at {edge_mm:g} mm; or peg_radius_mm is a diameter"
        )
        yield ConfigIssue(f"{key}.base_T_hole.face_radius_mm", f"{place.face_radius_mm:g}", allowed)
