"""What may be meant as it stands in a recipe, and is worth a second look."""

from collections.abc import Iterator
from pathlib import Path
from typing import cast

import numpy as np

from cellctl.config.cell import CellConfig
from cellctl.config.checks.arms.tool_floor import tool_floor_remarks
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.deck_to_frame.checks.hole_sizes import hole_size_remarks
from cellctl.processes.deck_to_frame.checks.pin_sizes import pin_size_remarks
from cellctl.processes.deck_to_frame.checks.plausible.drawing import PartDrawing, read_drawings
from cellctl.processes.deck_to_frame.checks.plausible.loads import load_remarks
from cellctl.processes.deck_to_frame.checks.plausible.stored import (
    calibrated_joints_deg,
    same_joints,
    stored_record,
)
from cellctl.processes.deck_to_frame.checks.shared_zones import unlike_box_remarks
from cellctl.processes.deck_to_frame.mating.planned_settings import RELEASE_BAND_N
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.record_names import BOARD_TRANSFER_NAME, PAYLOAD_NAME
from cellctl.processes.deck_to_frame.roles import FORCE, HEAD_1, HEAD_2, MAIN, MEASURING
from cellctl.processes.deck_to_frame.settings import DeckSettings
from cellctl.vision.registration.rigid_fit import on_a_line

_NEARLY = 0.05
"""Three holes are nearly on a line when they spread across it by less than this share of their
spread along it."""
_LEAST_PLACE_MM = 0.0013
"""What the best coordinate measuring machines tell of a place over 0.5 m, 0.9 µm + L/350 (greatest
permissible error by their makers, ISO 10360-2), over the root of three."""
_HEADS = (1.4, 3.0)
"""Over the bore of its screw; countersunk heads have 1.8 to 2.2 (ISO 10642, ISO 15065)."""
_USUAL_PAST_MM, _USUAL_WINDOW_MM = 0.5, 1.0
_MOST_LEFT = 0.6
"""Of the target, at the upper end of the band in which relaxing ends: the paper leaves 10 to 20 N
of its 35 N."""
_MOST_TOUCH = 0.4
"""Of the target, which is also the planned peak of the touch: what is noticed later leaves less
than three fifths of it for the time until the arm stands."""


def recipe_remarks(
    cell: CellConfig, recipe: DeckRecipe, key: str, folder: Path
) -> Iterator[ConfigIssue]:
    """Called with a file that is good."""
    deck, frame = read_drawings(recipe, key, folder)
    for drawing in (deck, frame):
        yield from _lines(drawing)
        yield from _exact_places(drawing)
    yield from pin_size_remarks(deck, frame)
    yield from _countersinks(deck)
    yield from _thickness_once(recipe, key, deck)
    yield from _compared(recipe, key)
    yield from _late(recipe, key)
    yield from _forces(recipe, key)
    yield from _corrections(recipe, key)
    yield from _board(cell, recipe, folder)
    yield from _payload(cell, recipe, folder)
    yield from hole_size_remarks(cell, recipe, (deck, frame), folder)
    yield from load_remarks(cell, recipe, key)
    yield from _taught_again(cell, recipe, folder)
    yield from unlike_box_remarks(cell, recipe)
    yield from tool_floor_remarks(cell, recipe.device(MAIN), recipe.flange_T_deck)


def _lines(drawing: PartDrawing) -> Iterator[ConfigIssue]:
    # The pose follows from the holes of both heads, so that a line of three is allowed. It is also
    # what a coordinate that was copied from the hole above looks like.
    for name in ("head_1", "head_2"):
        holes = getattr(drawing.features, name)
        places_m = np.array([drawing.position_mm(hole) for hole in holes]) * MM
        if len(holes) < 3:
            said = (
                "a head that sees fewer than three holes does not tell by itself which of them is "
                "elsewhere than drawn; right if no others are in its picture"
            )
            yield drawing.issue(name, str(list(holes)), said)
        elif on_a_line(places_m, _NEARLY):
            said = "these holes lie on one line; right if the drawing has them so"
            yield drawing.issue(name, str(list(holes)), said)


def _exact_places(drawing: PartDrawing) -> Iterator[ConfigIssue]:
    sigmas_mm = {hole.position_sigma_m / MM for hole in drawing.features.holes}
    sigma_mm = max(sigmas_mm, default=0.0)
    if 0.0 < sigma_mm < _LEAST_PLACE_MM:
        said = (
            "nothing else here tells how exactly the holes were made, and no gauge tells them "
            f"better than {_LEAST_PLACE_MM:g} mm: with too little the seat is called surer than "
            "it is"
        )
        yield drawing.issue("position_sigma_mm", f"{sigma_mm:g}", said)


def _countersinks(deck: PartDrawing) -> Iterator[ConfigIssue]:
    """A bore that is too narrow for the head that its countersink holds."""
    for hole in deck.features.holes:
        if hole.countersink_m is None:
            continue
        times = hole.countersink_m / hole.diameter_m
        said = (
            f"the countersink is {times:.2g} times as wide as its bore, and heads of screws are "
            "twice: is this the radius?"
        )
        if times > _HEADS[1]:
            yield deck.hole_issue(hole.name, "diameter_mm", f"{hole.diameter_m / MM:g}", said)
            return
        if times < _HEADS[0]:
            value = f"{hole.countersink_m / MM:g}"
            yield deck.hole_issue(hole.name, "countersink_mm", value, said)
            return


def _thickness_once(recipe: DeckRecipe, key: str, deck: PartDrawing) -> Iterator[ConfigIssue]:
    if deck.features.thickness_m is None:
        said = (
            "stated once, and nothing measures it before the deck touches: state thickness_mm in "
            "the deck's feature file too"
        )
        yield ConfigIssue(f"{key}.deck_thickness_mm", f"{recipe.deck_thickness_mm:g}", said)


def _compared(recipe: DeckRecipe, key: str) -> Iterator[ConfigIssue]:
    """The paper's ways, which are there to be compared with."""
    for name in ("rule", "method"):
        if getattr(recipe.pose_correction, name) == "paper":
            said = "of the paper, for comparison: it does not hold the thresholds of a production"
            yield ConfigIssue(f"{key}.pose_correction.{name}", "'paper'", said)


def _late(recipe: DeckRecipe, key: str) -> Iterator[ConfigIssue]:
    """Contacts that may come very early, or be pressed far beyond."""
    mating = recipe.mating
    presses_n = mating.max_past_contact_mm * mating.stiffness_n_per_mm
    if mating.max_past_contact_mm > _USUAL_PAST_MM:
        said = (
            f"if no stop were obeyed the arm would press with {presses_n:.0f} N here; the usual "
            f"{_USUAL_PAST_MM:g} mm are enough where the contact is known to its window"
        )
        value = f"{mating.max_past_contact_mm:g}"
        yield ConfigIssue(f"{key}.mating.max_past_contact_mm", value, said)
    if mating.contact_window_mm > _USUAL_WINDOW_MM:
        said = (
            f"a contact that comes so early is another part or something between: more than "
            f"{_USUAL_WINDOW_MM:g} mm is seldom meant"
        )
        yield ConfigIssue(f"{key}.mating.contact_window_mm", f"{mating.contact_window_mm:g}", said)


def _forces(recipe: DeckRecipe, key: str) -> Iterator[ConfigIssue]:
    """A touch and a rest that are nearly the force of the mating itself: a figure that was copied,
    or exchanged with it."""
    mating = recipe.mating
    target_n, left_n = mating.target_force_n, mating.release_force_n + RELEASE_BAND_N
    if left_n > _MOST_LEFT * target_n:
        said = (
            f"up to {left_n:g} N may be left for fastening, of target_force_n = {target_n:g}: more "
            f"than {_MOST_LEFT:g} of it hardly relaxes the joint"
        )
        yield ConfigIssue(f"{key}.mating.release_force_n", f"{mating.release_force_n:g}", said)
    touch_n = mating.touch_force_n
    if touch_n > _MOST_TOUCH * target_n:
        said = (
            f"what presses with less than half of it, {touch_n / 2.0:g} N, is taken for drift: "
            f"more than {_MOST_TOUCH:g} of target_force_n = {target_n:g} leaves little of the "
            "planned peak until the arm stands, and a soft contact is met unnoticed"
        )
        yield ConfigIssue(f"{key}.mating.touch_force_n", f"{touch_n:g}", said)


def _corrections(recipe: DeckRecipe, key: str) -> Iterator[ConfigIssue]:
    """A loop that cannot converge, and a limit that another one always precedes."""
    correction, where = recipe.pose_correction, f"{key}.pose_correction"
    if correction.max_iterations == 1:
        said = (
            "the loop is given up after one correction (F430), also of a deck that a second one "
            "would bring to its thresholds; right for a trial of the first"
        )
        yield ConfigIssue(f"{where}.max_iterations", "1", said)
    for unit in ("mm", "deg"):
        largest = float(getattr(correction, f"max_correction_{unit}"))
        allowed = 2.0 * float(getattr(recipe, f"station_tolerance_{unit}"))
        if largest > allowed:
            said = (
                f"it stops nothing: frame and deck that are each within station_tolerance_{unit} "
                f"differ by at most {allowed:g}; a smaller one finds a wrong measurement"
            )
            yield ConfigIssue(f"{where}.max_correction_{unit}", f"{largest:g}", said)


def _board(cell: CellConfig, recipe: DeckRecipe, folder: Path) -> Iterator[ConfigIssue]:
    """Another board than the one with which a head was calibrated."""
    settings = cast(DeckSettings, cell.processes[recipe.process])
    written = (*(int(side) for side in settings.board.split("x")), settings.square_mm)
    for role in (HEAD_1, HEAD_2):
        board = (stored_record(cell, folder, role) or {}).get("board", {})
        corners, square_mm = board.get("inner_corners"), board.get("square_mm")
        if corners is not None and (*corners, square_mm) != written:
            said = (
                f"the stored calibration of {role} was made with {corners[0]}x{corners[1]}, "
                f"squares of {square_mm:g} mm; right if there is another board now"
            )
            value = f"{settings.board!r}, square_mm = {settings.square_mm:g}"
            yield ConfigIssue(f"processes.{recipe.process}.board", value, said)
            return


def _payload(cell: CellConfig, recipe: DeckRecipe, folder: Path) -> Iterator[ConfigIssue]:
    """Another load, or a sensor mounted otherwise, than when the payload was identified."""
    record, main = stored_record(cell, folder, PAYLOAD_NAME), recipe.device(MAIN)
    load = cell.robots[main].load
    weighed = (record or {}).get("rigid12", {})
    com_mm, weighed_kg = weighed.get("centre_of_mass_mm"), weighed.get("mass_kg")
    if load is None or com_mm is None or weighed_kg is None:
        return
    # As procedure 106 compares them (cellctl.cell.arm_loads), before anything is connected.
    from cellctl.cell.arm_loads import weighed_checks

    sensor = cell.force_sensors[recipe.device(FORCE)]
    checks = weighed_checks(
        load, weighed_kg, np.array(com_mm) * MM, pose_from_xyzabc(sensor.flange_T_sensor)
    )
    if failed := [str(check) for check in checks if not check.passed]:
        said = (
            f"the stored {PAYLOAD_NAME} differs: {'; '.join(failed)}; flange_T_sensor may be "
            "turned, or identify the new load by procedure 106"
        )
        value = f"{load.mass_kg:g} kg at {list(load.com_mm)} mm"
        yield ConfigIssue(f"robots.{main}.load", value, said)


def _taught_again(cell: CellConfig, recipe: DeckRecipe, folder: Path) -> Iterator[ConfigIssue]:
    """A measuring pose from which the holes are in view, and which is not that of the transfer."""
    for role in (HEAD_1, HEAD_2):
        carrier = cell.stereo_cameras[recipe.device(role)].carried_by or ""
        joints = list(cell.robots[carrier].poses_deg[MEASURING])
        known = calibrated_joints_deg(cell, folder, role)
        if known is not None and not same_joints(known, joints):
            said = (
                f"the stored {BOARD_TRANSFER_NAME} was measured at {known} and holds there alone; "
                "right if the pose was taught again, then repeat procedure 104 or 105"
            )
            yield ConfigIssue(f"robots.{carrier}.poses_deg.{MEASURING}", str(joints), said)
