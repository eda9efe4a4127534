"""Reads and checks everything that a run needs before anything moves."""

import asyncio
from dataclasses import replace

from cellctl.calibration.store.store import CalibrationStore
from cellctl.clock import utc_now
from cellctl.force.contact.streamed.gains import LoopFigures
from cellctl.geometry.pose import MM
from cellctl.processes.peg_in_hole.calibrations import (
    CALIBRATIONS,
    CONTACT_LOOP,
    PANEL_REFERENCE,
)
from cellctl.processes.peg_in_hole.plan.cycle_plan import cycle_plan
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.run import PegFacts
from cellctl.processes.peg_in_hole.settings import PegSettings
from cellctl.processes.peg_in_hole.stations import PegCell
from cellctl.runtime.jobs.factory import PLANNED
from cellctl.runtime.process import Prepared

_MS = 1e-3


async def read_facts(
    cell: PegCell, recipe: PegRecipe, store: CalibrationStore
) -> Prepared[PegFacts]:
    """Plan with what procedure 301 has measured, else with the bounds of the settings.

    Raises the faults of a damaged calibration and of a panel's reference that is not valid any
    more, ``SearchImpossible``, ``HeightTooNoisy``, ``LoopTooSlow`` and ``LoopUnstable``.
    """
    kinds = [kind.for_recipe(recipe.id) for kind in CALIBRATIONS]
    panel = PANEL_REFERENCE.for_recipe(recipe.id)
    # One that was taken and is void says that something has moved: nobody may work on without it.
    taken = panel.name in await asyncio.to_thread(store.names)
    kinds = [replace(kind, required=taken) if kind.name == panel.name else kind for kind in kinds]
    # Looked at ahead of time, so that no calibration expires in the middle of the run.
    snapshot = await asyncio.to_thread(store.read_all, kinds, utc_now() + PLANNED)
    figures = snapshot.find(CONTACT_LOOP.for_recipe(recipe.id))
    measured = replace(cell, settings=with_measured(cell.settings, figures))
    facts = PegFacts.of(measured, recipe, cycle_plan(recipe, measured.settings))
    facts = replace(facts, panel=snapshot.find(panel))
    return Prepared(facts, tuple(snapshot.records))


def with_measured(settings: PegSettings, figures: LoopFigures | None) -> PegSettings:
    """The figures of procedure 301 in place of the bounds, where there are any."""
    if figures is None:
        return settings
    better = {
        "stiffness_n_mm": figures.stiffness_n_m * MM,
        "dead_time_ms": figures.dead_time_s / _MS,
    }
    return settings.model_copy(update=better)
