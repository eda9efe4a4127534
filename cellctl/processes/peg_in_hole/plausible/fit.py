"""Holds the drawing of a peg and its hole against itself."""

from collections.abc import Iterator
from math import degrees

from cellctl.config.checks.bounds.bound import Bound
from cellctl.geometry.pose import MM
from cellctl.processes.peg_in_hole.insertion.felt import OUT_OF_BAND_N
from cellctl.processes.peg_in_hole.insertion.resistance import ZONE_M
from cellctl.processes.peg_in_hole.plan.cycle_plan import fit_geometry
from cellctl.processes.peg_in_hole.recipe import Fit, PegRecipe
from cellctl.processes.peg_in_hole.verdict.judgement import HELD_MM

LEAST_FRICTION = 0.05
"""Of a dry pair; polytetrafluoroethylene on steel, the most slippery one in use, has about 0.04."""
_LEAST_KEY_PLAY_MM = 0.01
"""To either side of a key: half the width of the closest fit in which one slides (H7/g6)."""
_WIDE_MM, _WIDE_SHARE = 0.1, 0.02
"""Radial clearance of the widest usual fits: so much, and so much of the radius."""
_FAR_OUT = 1.35
"""Times the least radius of the touches; a wider circle tells the tilt of the face better, and a
twice as wide one needs a face four times as large."""
_PLACES_SHARE = 0.8
"""Of the radius that holds 99 of 100 places, the one that holds 95: 2.45 over 3.03 standard
deviations of two equal axes."""


def fit_bounds(recipe: PegRecipe, key: str) -> Iterator[Bound]:
    """Figures of a drawing that contradict each other, and touches that meet the hole."""
    where = f"{key}.fit"
    yield from drawing_bounds(recipe.fit, where)
    if recipe.fit.contacts is not None:
        why = "insertion_n: contacts that take more are never passed"
        most_n, name = recipe.forces.insertion_n, f"{where}.contacts.most_n"
        yield Bound(name, recipe.fit.contacts.most_n, why, most=most_n)
    yield _touches(recipe, key)
    yield from _proud(recipe, key)


def drawing_bounds(fit: Fit, where: str) -> Iterator[Bound]:
    """Clearance, chamfers, keys, contacts and outer face that this part cannot have; ``where`` is
    the key of the drawing."""
    why = "half of peg_radius_mm: so wide a bore is that of another peg, or peg_radius_mm is wrong"
    yield Bound(f"{where}.clearance_mm", fit.clearance_mm, why, most=fit.peg_radius_mm / 2)
    why = "half of peg_radius_mm, or the peg would have no front that stands on a face"
    yield Bound(f"{where}.peg_chamfer_mm", fit.peg_chamfer_mm, why, most=fit.peg_radius_mm / 2)
    why = "peg_radius_mm: no hole is chamfered by more than the peg is wide"
    yield Bound(f"{where}.hole_chamfer_mm", fit.hole_chamfer_mm, why, most=fit.peg_radius_mm)
    entry_mm = fit_geometry(fit).entry_depth_m / MM
    why = f"the peg is between the walls only {entry_mm:g} mm below the face, after both chamfers"
    yield Bound(f"{where}.depth_mm", fit.depth_mm, why, least=entry_mm)
    why = f"walls are felt by it, and no dry pair slides with less than {LEAST_FRICTION:g}"
    yield Bound(f"{where}.friction", fit.friction, why, least=LEAST_FRICTION)
    if fit.outer_radius_mm is not None:
        rim_mm = fit.peg_radius_mm + fit.clearance_mm + fit.hole_chamfer_mm
        why = "the bore with its chamfer lies within the outer face"
        yield Bound(f"{where}.outer_radius_mm", fit.outer_radius_mm, why, least=rim_mm)
    if fit.keys is not None:
        why = (
            f"keys meet their keyways after the peg has entered, before depth_mm = {fit.depth_mm:g}"
        )
        name = f"{where}.keys.depth_mm"
        yield Bound(name, fit.keys.depth_mm, why, least=entry_mm, most=fit.depth_mm)
        why = (
            f"keys at {fit.peg_radius_mm:g} mm with {_LEAST_KEY_PLAY_MM:g} mm of play to either "
            "side; no key slides with less, or is it in radians?"
        )
        least_deg = degrees(_LEAST_KEY_PLAY_MM / fit.peg_radius_mm)
        yield Bound(f"{where}.keys.window_deg", fit.keys.window_deg, why, least=least_deg)
    yield from _contacts(fit, where, entry_mm)


def wide_clearance(fit: Fit) -> str | None:
    """What is to be said of a clearance that is wider than the usual fits."""
    usual_mm = _WIDE_MM + _WIDE_SHARE * fit.peg_radius_mm
    if fit.clearance_mm <= usual_mm:
        return None
    return (
        f"wider than the fits of parts of this size, up to {usual_mm:.2g} mm; right if the "
        "drawing has it so: a hole that is too wide is found by what exceeds it"
    )


def _contacts(fit: Fit, where: str, entry_mm: float) -> Iterator[Bound]:
    contacts = fit.contacts
    if contacts is None:
        return
    why = f"contacts begin after the peg has entered, before depth_mm = {fit.depth_mm:g}"
    depth_mm, most_mm = contacts.depth_mm, fit.depth_mm
    yield Bound(f"{where}.contacts.depth_mm", depth_mm, why, least=entry_mm, most=most_mm)
    told_mm = 2 * ZONE_M / MM + HELD_MM
    why = (
        f"all contacts rub after they have begun (depth_mm = {depth_mm:g}), and {told_mm:g} mm "
        f"before the seat (depth_mm = {most_mm:g} of the fit), or no slip is told by them"
    )
    full_mm, latest_mm = contacts.full_mm, most_mm - told_mm
    yield Bound(f"{where}.contacts.full_mm", full_mm, why, least=depth_mm, most=latest_mm)
    why = f"more than a part that slides in freely meets, at most most_n = {contacts.most_n:g}"
    least_n = contacts.least_n
    name = f"{where}.contacts.least_n"
    yield Bound(name, least_n, why, least=OUT_OF_BAND_N, most=contacts.most_n)


def _touches(recipe: PegRecipe, key: str) -> Bound:
    """The foremost circle of the part, touching on a circle round the hole, must be beside it."""
    fit, place = recipe.fit, recipe.base_T_hole
    edge_mm = _edge_mm(fit, datum=place.datum_depth_mm > 0.0)
    off_mm = _PLACES_SHARE * place.uncertainty_mm
    why = (
        f"a part of {fit.peg_radius_mm:g} mm radius that touches nearer to the middle meets the "
        f"edge at {edge_mm:g} mm, where the hole may be {off_mm:g} mm off (uncertainty_mm = "
        f"{place.uncertainty_mm:g}); or peg_radius_mm is a diameter"
    )
    least_mm = _least_face_radius_mm(recipe)
    return Bound(f"{key}.base_T_hole.face_radius_mm", place.face_radius_mm, why, least=least_mm)


def _least_face_radius_mm(recipe: PegRecipe) -> float:
    """Radius of the circle on which a part touches beside its hole, wherever that is."""
    fit, place = recipe.fit, recipe.base_T_hole
    edge_mm = _edge_mm(fit, datum=place.datum_depth_mm > 0.0)
    off_mm = _PLACES_SHARE * place.uncertainty_mm
    return edge_mm + fit.peg_radius_mm - fit.peg_chamfer_mm + off_mm


def far_touches(recipe: PegRecipe) -> str | None:
    """What is to be said of touches that are farther out than this part needs."""
    least_mm, radius_mm = _least_face_radius_mm(recipe), recipe.base_T_hole.face_radius_mm
    if radius_mm <= _FAR_OUT * least_mm:
        return None
    return (
        f"{radius_mm / least_mm:.2g} times the {least_mm:.3g} mm at which a part of peg_radius_mm "
        f"= {recipe.fit.peg_radius_mm:g} touches beside its hole, and nothing in the file says "
        "that the face reaches so far. Is it a diameter, or peg_radius_mm half of the radius? "
        "Right if the face is so wide"
    )


def _proud(recipe: PegRecipe, key: str) -> Iterator[Bound]:
    """A raised plug is told from the panel that is touched round it by how far it stands proud."""
    fit, place = recipe.fit, recipe.base_T_hole
    nearest_mm = place.face_radius_mm - fit.peg_radius_mm
    if fit.outer_radius_mm is None or nearest_mm < fit.outer_radius_mm:
        return
    why = (
        f"the part touches {nearest_mm:g} mm from the middle and farther out, beside the raised "
        f"plug (outer_radius_mm = {fit.outer_radius_mm:g}), which stands proud of that by more "
        "than its height is uncertain"
    )
    least_mm = place.height_uncertainty_mm
    yield Bound(f"{key}.base_T_hole.datum_depth_mm", place.datum_depth_mm, why, least=least_mm)


def _edge_mm(fit: Fit, *, datum: bool) -> float:
    if datum and fit.outer_radius_mm is not None:
        return fit.outer_radius_mm
    return fit.peg_radius_mm + fit.clearance_mm + fit.hole_chamfer_mm
