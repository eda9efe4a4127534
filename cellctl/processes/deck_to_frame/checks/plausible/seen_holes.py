"""Says what is wrong where a head does not see the holes of its parts."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from pathlib import Path
from typing import cast

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.deck_to_frame.checks.plausible.drawing import read_drawings
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
from cellctl.processes.deck_to_frame.roles import (
    DECK_MEASURE,
    HEAD_1,
    HEAD_2,
    MAIN,
    MEASURING,
    RETRACTED,
)
from cellctl.processes.deck_to_frame.settings import DeckSettings

_APART_MM, _APART_DEG = 100.0, 10.0
"""More than bases of arms and heads on flanges are off their drawings."""
_FACING = 0.7
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
        elif modelled is not None and calibrated is not None and _apart(modelled, calibrated):
            found = _elsewhere(view, modelled, calibrated)
        elif calibrated is not None and not view.sees(calibrated):
            found = _beside(view, calibrated, "by the stored board transfer")
        elif modelled is None and calibrated is None:
            found = _spread(view)
        found = found or _board(view)
        if found is not None:
            yield found
            return  # the other head is mostly wrong by the same mistake


def _explained(
    view: HeadView, modelled: RigidTransform, calibrated: RigidTransform | None, folder: Path
) -> ConfigIssue:
    """The one change after which the head sees its holes, else the holes that it does not see."""
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
    written = view.cell.stereo_cameras[view.head].flange_T_camera
    if (turned := _turned_joint(view, folder)) is not None:
        return turned
    if calibrated is None or view.sees(calibrated):
        for other_pose in _with_other_signs(written or ()):
            if view.sees(view.camera(view.carrier, MEASURING, other_pose)):
                where = f"stereo_cameras.{view.head}.flange_T_camera"
                allowed = f"did you mean {other_pose}? so it would see the holes of its lists"
                return ConfigIssue(where, str(list(written or ())), allowed)
    return _beside(view, modelled, "by the model of the cell")


def _turned_joint(view: HeadView, folder: Path) -> ConfigIssue | None:
    """A joint of the measuring pose whose other sign would do; None where the pose is known to be
    right, or where the other head speaks for another place of the camera."""
    joints = list(view.cell.robots[view.carrier].poses_deg[MEASURING])
    known = calibrated_joints_deg(view.cell, folder, view.role)
    if known is not None and same_joints(known, joints):
        return None
    mountings = {
        camera.flange_T_camera
        for name, camera in view.cell.stereo_cameras.items()
        if name in {view.recipe.device(role) for role in (HEAD_1, HEAD_2)}
    }
    if known is None and len(mountings) > 1:
        return None
    for other in _with_other_signs(joints):
        flange = flange_at(view.cell, view.carrier, other)
        written = view.cell.stereo_cameras[view.head].flange_T_camera
        base = base_T_carrier(view.recipe, view.bases, view.carrier)
        if flange is None or written is None or base is None:
            return None
        if view.sees(base * flange * pose_from_xyzabc(written)):
            where = f"robots.{view.carrier}.poses_deg.{MEASURING}"
            allowed = f"did you mean {other}? so {view.head} would see the holes of its lists"
            return ConfigIssue(where, str(joints), allowed)
    return None


def _apart(modelled: RigidTransform, calibrated: RigidTransform) -> bool:
    between = modelled.inv() * calibrated
    away_m = float(np.linalg.norm(between.translation))
    turned_deg = float(np.degrees(between.rotation.magnitude()))
    return away_m > _APART_MM * MM or turned_deg > _APART_DEG


def _elsewhere(view: HeadView, modelled: RigidTransform, calibrated: RigidTransform) -> ConfigIssue:
    """A camera that sees its holes, and not from where it was when it was calibrated."""
    written = view.cell.stereo_cameras[view.head].flange_T_camera or ()
    meant = ""
    for other in _with_other_signs(written):
        camera = view.camera(view.carrier, MEASURING, other)
        if camera is not None and not _apart(camera, calibrated):
            meant = f"did you mean {other}? "
            break
    away_mm = float(np.linalg.norm((modelled.inv() * calibrated).translation)) / MM
    allowed = (
        f"{meant}{away_mm:.0f} mm away from where the stored board transfer has this camera, by "
        f"cell_T_base of {view.carrier} in the model of the cell"
    )
    where = f"stereo_cameras.{view.head}.flange_T_camera"
    return ConfigIssue(where, str(list(written)), allowed)


def _board(view: HeadView) -> ConfigIssue | None:
    """A target board that would lie behind the head, or on its side."""
    settings = cast(DeckSettings, view.cell.processes[view.recipe.process])
    mounted = view.cell.stereo_cameras[view.head].flange_T_camera
    written = settings.flange_T_target_board
    if mounted is None:
        return None
    camera_T_board = pose_from_xyzabc(mounted).inv() * pose_from_xyzabc(written)
    facing = abs(camera_T_board.rotation.as_matrix()[2, 2])
    if view.optics.holds(camera_T_board.translation) and facing > _FACING:
        return None
    allowed = f"a board in the picture of {view.head}, z of the board along that of the camera"
    where = f"processes.{view.recipe.process}.flange_T_target_board"
    return ConfigIssue(where, str(list(written)), allowed)


def _beside(view: HeadView, camera: RigidTransform, by_what: str) -> ConfigIssue:
    """Which of parts, poses and drawings is wrong, by which holes are outside of the picture."""
    unseen = view.unseen(camera)
    recipe, main = view.recipe, view.recipe.device(MAIN)
    listed = {part.drawing.part: part.holes_of(view.role) for part in view.parts}
    outside = f"{', '.join(next(names for names in unseen.values() if names))}"
    picture = f"outside of the picture of {view.head} at its pose {MEASURING}, {by_what}"
    both = len(unseen) == 2 and unseen["deck"] == unseen["frame"]
    some = any(0 < len(names) < len(listed[part]) for part, names in unseen.items())
    if some and (both or len(unseen) == 1):
        drawing = view.parts[0].drawing
        name = unseen["frame"][0]
        value = str(drawing.position_mm(name).tolist())
        also = f" (and in {view.parts[1].drawing.written})" if both else ""
        allowed = f"a place in view{also}; {outside} lies {picture}"
        return drawing.hole_issue(name, "position_mm", value, allowed)
    if not unseen["frame"]:
        joints = view.cell.robots[main].poses_deg[DECK_MEASURE]
        allowed = f"the holes of the deck in view; {outside} lies {picture}"
        return ConfigIssue(f"robots.{main}.poses_deg.{DECK_MEASURE}", str(list(joints)), allowed)
    if not unseen.get("deck", ["unknown"]):
        allowed = f"the holes of the frame in view; {outside} lies {picture}"
        return ConfigIssue(f"{view.key}.base_T_frame", str(list(recipe.base_T_frame)), allowed)
    joints = view.cell.robots[view.carrier].poses_deg[MEASURING]
    allowed = f"{outside} of {view.parts[0].drawing.written} in view; it lies {picture}"
    where = f"robots.{view.carrier}.poses_deg.{MEASURING}"
    return ConfigIssue(where, str(list(joints)), allowed)


def _with_other_signs(written: Sequence[float]) -> Iterator[list[float]]:
    """The pose with the signs of one or two of its figures turned."""
    for count in (1, 2):
        for turned in combinations((index for index, one in enumerate(written) if one), count):
            yield [-one if index in turned else one for index, one in enumerate(written)]


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
