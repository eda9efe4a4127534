"""From the recipe and the cell's figures to the plan of one cycle; nothing moves here."""

from math import radians

from cellctl.geometry.pose import MM
from cellctl.processes.peg_in_hole.cycle import CyclePlan
from cellctl.processes.peg_in_hole.plan.choice import choose_search
from cellctl.processes.peg_in_hole.plan.task import (
    CellFigures,
    FitGeometry,
    ForceLimits,
    KeyGeometry,
    PartContacts,
    SearchTask,
)
from cellctl.processes.peg_in_hole.recipe import (
    ContactsSection,
    Fit,
    KeysSection,
    PegRecipe,
    Seat,
)
from cellctl.processes.peg_in_hole.search.face import FacePlan
from cellctl.processes.peg_in_hole.settings import PegSettings
from cellctl.processes.peg_in_hole.verdict.judgement import PegSeatLimits

_MS = 1e-3


def cycle_plan(recipe: PegRecipe, settings: PegSettings) -> CyclePlan:
    """Raises ``SearchImpossible`` or ``HeightTooNoisy`` with the figures that say why."""
    task, place = search_task(recipe, settings), recipe.base_T_hole
    return CyclePlan(
        task,
        choose_search(task, recipe.search),
        seat_limits(recipe.fit, recipe.seat),
        FacePlan(
            place.face_radius_mm * MM, place.height_uncertainty_mm * MM, place.datum_depth_mm * MM
        ),
        recipe.seat.grip_n,
    )


def _keys(section: KeysSection) -> KeyGeometry:
    return KeyGeometry(
        section.depth_mm * MM,
        radians(section.window_deg),
        radians(section.uncertainty_deg),
    )


def _contacts(section: ContactsSection) -> PartContacts:
    return PartContacts(
        section.depth_mm * MM, section.full_mm * MM, section.least_n, section.most_n
    )


def seat_limits(fit: Fit, seat: Seat) -> PegSeatLimits:
    """What a good part feels like at its seat."""
    return PegSeatLimits(seat.least_n, seat.most_n, keyed=fit.keys is not None, pull_n=seat.pull_n)


def fit_geometry(fit: Fit) -> FitGeometry:
    """The drawing in SI units."""
    outer_mm = fit.outer_radius_mm
    return FitGeometry(
        fit.peg_radius_mm * MM,
        fit.clearance_mm * MM,
        fit.hole_chamfer_mm * MM,
        fit.peg_chamfer_mm * MM,
        fit.depth_mm * MM,
        None if outer_mm is None else outer_mm * MM,
        None if fit.keys is None else _keys(fit.keys),
        None if fit.contacts is None else _contacts(fit.contacts),
    )


def search_task(recipe: PegRecipe, settings: PegSettings) -> SearchTask:
    """The task in SI units."""
    fit, forces, place = recipe.fit, recipe.forces, recipe.base_T_hole
    return SearchTask(
        fit_geometry(fit),
        CellFigures(
            settings.stiffness_n_mm / MM,
            settings.dead_time_ms * _MS,
            place.uncertainty_mm * MM,
            settings.repeatability_mm * MM,
            settings.height_sigma_mm * MM,
            settings.force_sigma_n,
            fit.friction,
        ),
        ForceLimits(forces.search_n, forces.insertion_n, forces.fault_n, forces.fault_nm),
    )
