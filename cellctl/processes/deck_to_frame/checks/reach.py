"""Checks that the arm can hold the deck above its seat, and on it."""

from collections.abc import Iterator

from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.driver_settings import motion_bounds
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.deck_to_frame.recipe import DeckRecipe


def reach_issues(
    cell: CellConfig, main: str, recipe: DeckRecipe, key: str
) -> Iterator[ConfigIssue]:
    """The nominal flange poses at the stand-off and at the seat, against the driver's bounds."""
    box = motion_bounds(cell.robots[main]).flange_box
    if box is None:
        return
    base_T_frame = pose_from_xyzabc(recipe.base_T_frame)
    deck_T_flange = pose_from_xyzabc(recipe.flange_T_deck).inv()
    for what, above_mm in (("seated", 0.0), ("at the stand-off", recipe.stand_off_mm)):
        height_m = (recipe.deck_thickness_mm + above_mm) * MM
        frame_T_deck = RigidTransform.from_translation([0.0, 0.0, height_m])
        place_m = (base_T_frame * frame_T_deck * deck_T_flange).translation
        if not box.holds(place_m):
            x, y, z = place_m / MM
            allowed = (
                f"with the deck {what} the flange is at x {x:.0f}, y {y:.0f}, z {z:.0f} mm, "
                f"outside the box that robots.{main}.settings give it"
            )
            yield ConfigIssue(f"{key}.base_T_frame", str(list(recipe.base_T_frame)), allowed)
            return
