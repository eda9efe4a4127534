"""Figures in the two feature files of a recipe that no part has, or that do not go together."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.checks.plausible.drawing import PartDrawing
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.vision.features.hole import Hole

_MOST_HOLE_MM = 50.0
"""A wider one leaves no face round it in a field of view of 0.3 m."""
_LEAST_MM, _LEAST_HOLE_MM = 5.0, 0.5
"""Holes of a part are spread wider, and are wider, than this: else they stand there in metres."""
_OUTWARD = 0.9
"""Cosine: the heads see both parts from above, and the deck comes from there (mission A3)."""
_PIN_MM = 0.1
"""One pin goes through both holes, with a few hundredths in each."""
_PIN_PLACE_MM = 0.05
"""Two drawings have one pin at one place; what was measured on each part differs by less."""
_HALF, _TWICE = (0.45, 0.55), (1.8, 2.2)
"""Ratios of two diameters by which a drawing has the radius in place of one."""
_BORE = (0.8, 1.65)
"""Limits of a deck's bore over the thread below it, which a drawing has as nominal or as core
diameter: from a core hole to the coarse clearance hole of ISO 273, over the core of M2 or more."""
_ABOVE_MM = 1.0
"""Height above the outer face of a deck up to which a bore may lie, on a boss."""
_FLATTEST = 0.57
"""Depth of a countersink of 120 degrees over half of what it is wider than its bore; no screw has a
flatter head."""
_SHARE_OF_THRESHOLD = 3.0
"""A measured pose counts when its standard deviation is a third of the threshold."""


def drawing_issues(
    deck: PartDrawing, frame: PartDrawing, recipe: DeckRecipe
) -> Iterator[ConfigIssue]:
    """Called with files that can be read and from which poses follow."""
    for drawing in (deck, frame):
        in_metres = list(_in_metres(drawing))
        yield from in_metres
        if not in_metres:
            yield from _outward(drawing)
            yield from _overlapping(drawing)
            yield from _heights(drawing, recipe)
            yield from _uncertain(drawing, recipe)
    yield from _pairs(deck, frame)
    yield from _heads(deck, frame)


def _in_metres(drawing: PartDrawing) -> Iterator[ConfigIssue]:
    places_mm = np.array([drawing.position_mm(name) for name in drawing.holes])
    first = next(iter(drawing.holes))
    if np.ptp(places_mm, axis=0).max() < _LEAST_MM:
        value = str(drawing.position_mm(first).tolist())
        allowed = "millimetres; all holes within 5 mm look like metres"
        yield drawing.hole_issue(first, "position_mm", value, allowed)
    for hole in drawing.features.holes:
        diameter_mm = hole.diameter_m / MM
        if not _LEAST_HOLE_MM <= diameter_mm <= _MOST_HOLE_MM:
            value = f"{diameter_mm:g}"
            allowed = f"{_LEAST_HOLE_MM:g} to {_MOST_HOLE_MM:g} mm"
            yield drawing.hole_issue(hole.name, "diameter_mm", value, allowed)
            return


def _outward(drawing: PartDrawing) -> Iterator[ConfigIssue]:
    outward = drawing.features.holes[0].outward
    if outward is not None and outward[2] < _OUTWARD:
        allowed = "[0.0, 0.0, 1.0]: the heads look down on the face, and z is up out of it"
        yield drawing.issue("outward_axis", str(outward.tolist()), allowed)


def _overlapping(drawing: PartDrawing) -> Iterator[ConfigIssue]:
    for one, other in combinations(drawing.features.holes, 2):
        apart_m = float(np.linalg.norm(np.subtract(one.position_m, other.position_m)))
        if apart_m < (one.diameter_m + other.diameter_m) / 2.0:
            value = str(drawing.position_mm(other.name).tolist())
            allowed = f"another place than that of hole {one.name}, {apart_m / MM:g} mm away"
            yield drawing.hole_issue(other.name, "position_mm", value, allowed)
            return


def _heights(drawing: PartDrawing, recipe: DeckRecipe) -> Iterator[ConfigIssue]:
    deep_mm = recipe.deck_thickness_mm if drawing.part == "deck" else np.inf
    for name, hole in drawing.holes.items():
        place_mm = drawing.position_mm(name)
        top_mm, why = _highest(drawing.part, hole)
        if not -deep_mm <= place_mm[2] <= top_mm:
            least = "" if np.isinf(deep_mm) else f"from -{deep_mm:g} "
            allowed = (
                f"z {least}up to {top_mm:.2g}: z = 0 is the face that the heads see, and {why}"
            )
            yield drawing.hole_issue(name, "position_mm", str(place_mm.tolist()), allowed)
            return


def _highest(part: str, hole: Hole) -> tuple[float, str]:
    """How high (mm) the rim of a hole may lie, and why."""
    if part == "frame":
        return 0.0, "the deck sits on it: a rim lies in it or, under a chamfer, below"
    if hole.countersink_m is not None:
        deep_mm = _FLATTEST * (hole.countersink_m - hole.diameter_m) / 2.0 / MM
        return -deep_mm, f"the rim of the bore lies below a countersink, {deep_mm:.2g} mm or more"
    return _ABOVE_MM, "a boss is seldom higher"


def _uncertain(drawing: PartDrawing, recipe: DeckRecipe) -> Iterator[ConfigIssue]:
    holes = {*drawing.features.head_1, *drawing.features.head_2}
    threshold_mm = recipe.pose_correction.threshold_mm
    most_mm = threshold_mm / _SHARE_OF_THRESHOLD * float(np.sqrt(len(holes)))
    sigma_mm = drawing.features.holes[0].position_sigma_m / MM
    if sigma_mm > most_mm:
        allowed = (
            f"at most {most_mm:.3f}: {len(holes)} such holes do not give a pose to a third of "
            f"threshold_mm = {threshold_mm:g}"
        )
        yield drawing.issue("position_sigma_mm", f"{sigma_mm:g}", allowed)


def _pairs(deck: PartDrawing, frame: PartDrawing) -> Iterator[ConfigIssue]:
    """Holes of one name are in line, and one screw or one pin goes through both."""
    for name, hole in deck.holes.items():
        below = frame.holes.get(name)
        if below is None:
            continue
        if (hole.kind == "pin") != (below.kind == "pin"):
            allowed = f"as hole {name} of {frame.written}, which is a {below.kind}"
            yield deck.hole_issue(name, "kind", repr(hole.kind), allowed)
            continue
        if hole.kind == below.kind == "thread":
            allowed = (
                f"a bore over the thread of {frame.written}, or a pin in both files: a screw in "
                "two threads presses nothing together"
            )
            yield deck.hole_issue(name, "kind", repr(hole.kind), allowed)
            continue
        above_mm, below_mm = hole.diameter_m / MM, below.diameter_m / MM
        if hole.kind == "pin":
            wrong = abs(above_mm - below_mm) > _PIN_MM
            wanted = f"{below_mm:g}, give or take {_PIN_MM:g}, as one pin goes through both"
        else:
            wrong = not _BORE[0] * below_mm <= above_mm <= _BORE[1] * below_mm
            wanted = f"{_BORE[0] * below_mm:.3g} to {_BORE[1] * below_mm:.3g} for one screw"
        if wrong:
            allowed = f"{wanted}; hole {name} of {frame.written} has {below_mm:g}"
            allowed += _radius(above_mm / below_mm, deck.written, frame.written)
            yield deck.hole_issue(name, "diameter_mm", f"{above_mm:g}", allowed)
        elif hole.kind == "pin":
            yield from _pin_places(deck, frame, name)


def _radius(ratio: float, above: str, below: str) -> str:
    """The slip that two diameters tell of which one is half the other; empty for others."""
    if _HALF[0] <= ratio <= _HALF[1]:
        return f": this is half of it, as the radius is in place of the diameter in {above}"
    if _TWICE[0] <= ratio <= _TWICE[1]:
        return f": this is twice as much, as the radius is in place of the diameter in {below}"
    return ""


def _pin_places(deck: PartDrawing, frame: PartDrawing, name: str) -> Iterator[ConfigIssue]:
    """The pins hold the parts where the drawings have them, whatever the other holes say."""
    above_mm, below_mm = deck.position_mm(name), frame.position_mm(name)
    if np.max(np.abs(above_mm - below_mm)[:2]) > _PIN_PLACE_MM:
        allowed = (
            f"x and y within {_PIN_PLACE_MM:g} of {below_mm[:2].tolist()}, where it is in "
            f"{frame.written}: one pin goes through both"
        )
        yield deck.hole_issue(name, "position_mm", str(above_mm.tolist()), allowed)


def _heads(deck: PartDrawing, frame: PartDrawing) -> Iterator[ConfigIssue]:
    """The heads measure both parts from one place, so each sees the same holes of both."""
    for key, other_key in (("head_1", "head_2"), ("head_2", "head_1")):
        of_deck, of_other = getattr(deck.features, key), getattr(frame.features, other_key)
        if strange := [name for name in of_deck if name in of_other]:
            allowed = f"without {strange[0]}, which {other_key} sees in {frame.written}"
            yield deck.issue(key, str(list(of_deck)), allowed)
            return
