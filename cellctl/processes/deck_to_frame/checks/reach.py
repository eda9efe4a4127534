"""Checks that the arm can hold the deck above its seat, and on it."""

from collections.abc import Iterator

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.checks.bounds.bound import Bound
from cellctl.config.checks.places.flange_places import box_of
from cellctl.config.checks.places.over_places import about
from cellctl.config.driver_settings import motion_bounds, robot_driver
from cellctl.config.issue import ConfigIssue, WrittenValue
from cellctl.geometry.box import Box
from cellctl.geometry.pose import MM, Array, pose_from_xyzabc
from cellctl.processes.deck_to_frame.checks.meant_pose import STATION_POSES, meant_pose
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.roles import DECK_MEASURE

_SEATED = "seated"
"""The place at which the deck lies on the frame, as findings name it."""
BESIDE_MM = 100.0
TURNED_DEG = 8.0
"""The heads measure deck and frame from one place. In a field of view of 0.3 m the holes of a head
leave 0.1 m to either side; a deck tilted by more has its holes at other distances than the frame,
by a tenth of its length."""


def reach_issues(
    cell: CellConfig, main: str, recipe: DeckRecipe, key: str
) -> Iterator[ConfigIssue]:
    """The nominal flange poses at the stand-off and at the seat, against the driver's bounds."""
    box = motion_bounds(cell.robots[main]).flange_box
    if box is None or (outside := _outside(recipe, box)) is None:
        return
    what, place_m = outside
    base_T_flange = _measured_at(cell, main)
    x, y, z = place_m / MM
    found = (
        f"with the deck {what} the flange is at x {x:.0f}, y {y:.0f}, z {z:.0f} mm, "
        f"outside the box that robots.{main}.settings give it"
    )
    # The box alone holds many poses. Only where the taught pose agrees with it as well do two
    # values speak against the one that is written.
    meant = None if base_T_flange is None else _meant(recipe, box, base_T_flange)
    if meant is not None:
        name, other = meant
        allowed = f"did you mean {other}? It agrees with the box and with {DECK_MEASURE}; {found}"
        yield ConfigIssue(f"{key}.{name}", str(list(getattr(recipe, name))), allowed)
        return
    frame, deck = (_written(recipe, key, name) for name in STATION_POSES)
    thickness = WrittenValue(f"{key}.deck_thickness_mm", f"{recipe.deck_thickness_mm:g}")
    stand_off = WrittenValue(f"{key}.stand_off_mm", f"{recipe.stand_off_mm:g}")
    heights = (thickness,) if what == _SEATED else (thickness, stand_off)
    against = (deck, *heights, box_of(main, box))
    yield ConfigIssue(frame.key, frame.value, found, against=against)


def above_issues(
    cell: CellConfig, main: str, recipe: DeckRecipe, key: str
) -> Iterator[ConfigIssue]:
    """A frame that is not below the deck at its taught pose."""
    base_T_flange = _measured_at(cell, main)
    if base_T_flange is None:
        return
    place = frame_T_deck(recipe, base_T_flange)
    x_mm, y_mm, _ = place.translation / MM
    if is_beside(place):
        # At the same height, right below the deck.
        base_T_deck = base_T_flange * pose_from_xyzabc(recipe.flange_T_deck)
        above = RigidTransform.from_translation([0.0, 0.0, float(place.translation[2])])
        frame = _written(recipe, key, "base_T_frame", base_T_deck * above.inv())
        base_T_frame = pose_from_xyzabc(recipe.base_T_frame)
        deck = _written(recipe, key, "flange_T_deck", base_T_flange.inv() * base_T_frame * above)
        turned_deg = np.degrees(place.rotation.magnitude())
        allowed = (
            f"{frame.allowed}: below the deck at the taught pose {DECK_MEASURE}, within "
            f"{BESIDE_MM:g} mm and {TURNED_DEG:g} deg; the deck is at x {x_mm:.0f}, y {y_mm:.0f} "
            f"mm of the frame, turned by {turned_deg:.0f} deg. Or teach {DECK_MEASURE} again"
        )
        yield ConfigIssue(frame.key, frame.value, allowed, against=(deck, _taught(cell, main)))


def height_bounds(cell: CellConfig, main: str, recipe: DeckRecipe, key: str) -> Iterator[Bound]:
    """The stand-off between a deck at its taught pose and the frame below it."""
    base_T_flange = _measured_at(cell, main)
    if base_T_flange is None or is_beside(place := frame_T_deck(recipe, base_T_flange)):
        return
    z_mm = float(place.translation[2]) / MM
    why = (
        f"at the taught pose {DECK_MEASURE} the outer face of the deck is {z_mm:.0f} mm above the "
        "frame, and the stand-off below the deck stays free"
    )
    most_mm = z_mm - recipe.stand_off_mm
    where = f"{key}.deck_thickness_mm"
    against = (_taught(cell, main),)
    yield Bound(where, recipe.deck_thickness_mm, why, most=most_mm, against=against)


def _taught(cell: CellConfig, main: str) -> WrittenValue:
    joints = list(cell.robots[main].poses_deg[DECK_MEASURE])
    return WrittenValue(f"robots.{main}.poses_deg.{DECK_MEASURE}", str(joints))


def _meant(
    recipe: DeckRecipe, box: Box, base_T_flange: RigidTransform
) -> tuple[str, list[float]] | None:
    def fits(other: DeckRecipe) -> bool:
        return _outside(other, box) is None and not is_beside(frame_T_deck(other, base_T_flange))

    return meant_pose(recipe, fits)


def _written(
    recipe: DeckRecipe, key: str, name: str, meant: RigidTransform | None = None
) -> WrittenValue:
    allowed = "" if meant is None else about(meant)
    return WrittenValue(f"{key}.{name}", str(list(getattr(recipe, name))), allowed=allowed)


def frame_T_deck(recipe: DeckRecipe, base_T_flange: RigidTransform) -> RigidTransform:
    """The deck in the nominal frame, with the flange at a pose."""
    base_T_deck = base_T_flange * pose_from_xyzabc(recipe.flange_T_deck)
    return pose_from_xyzabc(recipe.base_T_frame).inv() * base_T_deck


def is_beside(place: RigidTransform) -> bool:
    """Whether a deck, seen from the frame, is where the heads cannot see both."""
    x_mm, y_mm, _ = place.translation / MM
    turned_deg = np.degrees(place.rotation.magnitude())
    return bool(np.hypot(x_mm, y_mm) > BESIDE_MM or turned_deg > TURNED_DEG)


def _measured_at(cell: CellConfig, main: str) -> RigidTransform | None:
    """The flange at the taught pose over the station; None where the arm is not described."""
    robot = cell.robots[main]
    driver, settings = robot_driver(robot)
    kinematics = driver.forward_kinematics(settings)
    return None if kinematics is None else kinematics(np.radians(robot.poses_deg[DECK_MEASURE]))


def _outside(recipe: DeckRecipe, box: Box) -> tuple[str, Array] | None:
    """A place outside of its box where the flange would have to be, in words and in m; None where
    there is none."""
    base_T_frame = pose_from_xyzabc(recipe.base_T_frame)
    deck_T_flange = pose_from_xyzabc(recipe.flange_T_deck).inv()
    for what, above_mm in ((_SEATED, 0.0), ("at the stand-off", recipe.stand_off_mm)):
        height_m = (recipe.deck_thickness_mm + above_mm) * MM
        seat_T_deck = RigidTransform.from_translation([0.0, 0.0, height_m])
        place_m = (base_T_frame * seat_T_deck * deck_T_flange).translation
        if not box.holds(place_m):
            return what, place_m
    return None
