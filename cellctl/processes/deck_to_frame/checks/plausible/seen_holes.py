"""Says what is wrong where a head does not see the holes of its parts."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import cast

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.issue import ConfigIssue, WrittenValue
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.deck_to_frame.checks.plausible.drawing import read_drawings
from cellctl.processes.deck_to_frame.checks.plausible.head_mounting import (
    is_apart,
    mounted_elsewhere,
)
from cellctl.processes.deck_to_frame.checks.plausible.sight import (
    Optics,
    base_T_carrier,
    calibrated_camera,
    flange_at,
    parts_under_heads,
)
from cellctl.processes.deck_to_frame.checks.plausible.stored import (
    calibrated_joints_deg,
    same_joints,
)
from cellctl.processes.deck_to_frame.checks.plausible.view import HeadView
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.record_names import BOARD_TRANSFER_NAME
from cellctl.processes.deck_to_frame.roles import (
    HEAD_1,
    HEAD_2,
    MEASURING,
    RETRACTED,
)
from cellctl.processes.deck_to_frame.settings import DeckSettings

_FACING = 0.7
"""Cosine of the angle at which a head may look at a board: some 45°."""
_WIDEST_MM = 400.0
"""From hole to hole of one head whose place is not known: the diagonal of a field of 0.3 m."""


def sight_issues(
    cell: CellConfig,
    recipe: DeckRecipe,
    key: str,
    folder: Path,
    bases: Mapping[str, Sequence[float]],
) -> Iterator[ConfigIssue]:
    """Heads that look beside their holes; ``bases`` are ``cell_T_base`` by robot, as the model of
    the cell has them."""
    parts = parts_under_heads(cell, recipe, *read_drawings(recipe, key, folder))
    for role in (HEAD_1, HEAD_2):
        optics = Optics.of_head(cell, folder, role)
        view = HeadView(cell, recipe, key, role, parts, optics, bases)
        modelled = view.camera(view.carrier, MEASURING)
        calibrated = calibrated_camera(cell, recipe, folder, role)
        found = None
        if modelled is not None and not view.sees(modelled):
            found = _explained(view, modelled, calibrated, folder)
        elif modelled is not None and calibrated is not None and is_apart(modelled, calibrated):
            found = mounted_elsewhere(view, modelled, calibrated)
        elif calibrated is not None and not view.sees(calibrated):
            found = _beside(view, calibrated, (view.by_transfer(),))
        elif modelled is None and calibrated is None:
            found = _spread(view)
        found = found or _board(view)
        if found is not None:
            yield found
            return  # the other head is mostly wrong by the same mistake


def _explained(
    view: HeadView, modelled: RigidTransform, calibrated: RigidTransform | None, folder: Path
) -> ConfigIssue:
    """What stored calibrations or another arm decide, else everything that contradicts."""
    arm = view.cell.robots[view.carrier]
    if view.sees(view.camera(view.carrier, RETRACTED)):
        allowed = f"a pose over the station; from {RETRACTED} {view.head} would see its holes: "
        value = str(list(arm.poses_deg[MEASURING]))
        where = f"robots.{view.carrier}.poses_deg.{MEASURING}"
        return ConfigIssue(where, value, f"{allowed}did you exchange them?")
    for other in view.cell.robots:
        if other != view.carrier and view.sees(view.camera(other, MEASURING)):
            where = f"stereo_cameras.{view.head}.carried_by"
            allowed = (
                f"did you mean '{other}'? from there it would see its holes; or head_1 "
                "and head_2 are exchanged in both feature files"
            )
            return ConfigIssue(where, repr(view.carrier), allowed)
    if (moved := _moved_since(view, folder)) is not None:
        return moved
    if calibrated is not None and view.sees(calibrated):
        return mounted_elsewhere(view, modelled, calibrated)
    if calibrated is not None and not is_apart(modelled, calibrated):
        return _beside(view, calibrated, (view.by_transfer(),))
    return _beside(view, modelled, view.camera_from())


def _moved_since(view: HeadView, folder: Path) -> ConfigIssue | None:
    """A measuring pose that is not the one of the board transfer, from which the holes are seen."""
    joints = list(view.cell.robots[view.carrier].poses_deg[MEASURING])
    known = calibrated_joints_deg(view.cell, folder, view.role)
    if known is None or same_joints(known, joints):
        return None
    flange = flange_at(view.cell, view.carrier, known)
    mounted = view.cell.stereo_cameras[view.head].flange_T_camera
    base = base_T_carrier(view.recipe, view.bases, view.carrier)
    if flange is None or mounted is None or base is None:
        return None
    if not view.sees(base * flange * pose_from_xyzabc(mounted)):
        return None
    where = f"robots.{view.carrier}.poses_deg.{MEASURING}"
    allowed = (
        f"did you mean {known}? With these joints the stored {BOARD_TRANSFER_NAME} was measured, "
        f"and {view.head} sees the holes of its lists"
    )
    return ConfigIssue(where, str(joints), allowed)


def _board(view: HeadView) -> ConfigIssue | None:
    """A target board that would lie behind the head, or on its side."""
    settings = cast(DeckSettings, view.cell.processes[view.recipe.process])
    mounted = view.mounted_mm_deg()
    written = settings.flange_T_target_board
    if not mounted:
        return None
    camera_T_board = pose_from_xyzabc(mounted).inv() * pose_from_xyzabc(written)
    facing = abs(camera_T_board.rotation.as_matrix()[2, 2])
    if view.optics.holds(camera_T_board.translation) and facing > _FACING:
        return None
    allowed = f"a board in the picture of {view.head}, z of the board along that of the camera"
    where = f"processes.{view.recipe.process}.flange_T_target_board"
    return ConfigIssue(where, str(list(written)), allowed, against=(view.mounting(),))


def _beside(
    view: HeadView, camera: RigidTransform, camera_from: tuple[WrittenValue, ...]
) -> ConfigIssue:
    """Which holes are outside of the picture, and every value from which that follows;
    ``camera_from`` are those from which the place of the camera does."""
    unseen = view.unseen(camera)
    listed = {part.drawing.part: part.holes_of(view.role) for part in view.parts}
    outside = f"{', '.join(next(names for names in unseen.values() if names))}"
    picture = f"outside of the picture of {view.head} at its pose {MEASURING}"
    both = len(unseen) == 2 and unseen["deck"] == unseen["frame"]
    some = any(0 < len(names) < len(listed[part]) for part, names in unseen.items())
    frame, deck = view.frame_from(), view.deck_from()
    if some and (both or len(unseen) == 1):
        drawing = view.parts[0].drawing
        name = unseen["frame"][0]
        value = str(drawing.position_mm(name).tolist())
        also = f" (and in {view.parts[1].drawing.written})" if both else ""
        allowed = f"a place in view{also}; {outside} lies {picture}"
        against = (*camera_from, *frame, *(deck if both else ()))
        return drawing.hole_issue(name, "position_mm", value, allowed, against)
    if not unseen["frame"]:
        # The frame is seen from there, so the camera is where it should be.
        allowed = f"the holes of the deck in view; {outside} lies {picture}"
        return _first(deck, allowed)
    if not unseen.get("deck", ["unknown"]):
        allowed = f"the holes of the frame in view; {outside} lies {picture}"
        return _first(frame, allowed)
    allowed = f"{outside} of {view.parts[0].drawing.written} in view; it lies {picture}"
    if len(camera_from) > 1:
        return _first((*camera_from, *frame, *deck), allowed)
    return _first((*frame, *deck, *camera_from), allowed)  # a measured place is no key of the file


def _first(values: Sequence[WrittenValue], allowed: str) -> ConfigIssue:
    first, *others = values
    return ConfigIssue(first.key, first.value, allowed, against=tuple(others))


def _spread(view: HeadView) -> ConfigIssue | None:
    """Holes of one head that no field of view holds, where nothing says where the head stands."""
    drawing = view.parts[0].drawing
    names = view.parts[0].holes_of(view.role)
    places_mm = np.array([drawing.position_mm(name) for name in names])
    away_mm = np.linalg.norm(places_mm[:, None] - places_mm[None], axis=2)
    if away_mm.max() <= _WIDEST_MM:
        return None
    farthest = int(np.argmax(away_mm.sum(axis=0)))
    name = names[farthest]
    allowed = (
        f"within {_WIDEST_MM:g} mm of the other holes of {view.role}, which sees them in one "
        f"picture; {away_mm[farthest].max():.0f} mm away"
    )
    value = str(places_mm[farthest].tolist())
    return drawing.hole_issue(name, "position_mm", value, allowed)
