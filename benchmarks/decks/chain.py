"""One deck, one seed: measured and corrected until the loop says so, then mated, in one world.

There is no wire and no clock: the mating is that of `benchmarks.mating`, but it begins with the
deck where the loop has left it, and with the pose and the uncertainty that the loop has found.
"""

from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from benchmarks.decks.deck_range import Deck, payload_kg, scenario_of, setting_of
from benchmarks.metrology.loop import LoopEnd, Setting, follow_loop
from cellctl.config.devices import ForceSensorConfig
from cellctl.errors.base import CellError
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.commissioned_contact import Commissioned
from cellctl.processes.deck_to_frame.mating.mate import mate
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan, plan_mating
from cellctl.processes.deck_to_frame.mating.planned_settings import mating_settings
from cellctl.processes.deck_to_frame.mating.result import MatingPhase, MatingProgress, MatingResult
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from tests.rigs.mating.cell import MatingCell
from tests.rigs.mating.simulated_loop import run_simulated

PIN_LIMIT_MM = 0.2
FORCE_LIMIT_N = 50.0


class Outcome(StrEnum):
    """How a deck ended."""

    GOOD = "good"
    REFUSED = "refused"
    """By the loop, the plan or the mating, with a fault; nothing was called good."""
    FALSE = "called good, is not"


@dataclass(frozen=True, slots=True)
class Figures:
    """Truth at the end; mm, degrees and N. None where the deck did not get so far."""

    deck: str
    seed: int
    outcome: Outcome
    text: str = ""
    looks: int | None = None
    off_about_weak_deg: float | None = None
    """Error of the last look: the worst of the rotations about x and y."""
    normalised_squared: float | None = None
    speed_mm_s: float | None = None
    lateral_mm: float | None = None
    """The worst pin hole."""
    gap_mm: float | None = None
    peak_n: float | None = None
    final_n: float | None = None

    def row(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)


def run_chain(
    deck: Deck,
    shipped: Setting,
    sensor: ForceSensorConfig,
    commissioned: Commissioned,
    scenario: DeckScenario,
    seed: int,
) -> Figures:
    """Draw a cell for the deck and assemble it."""
    setting = setting_of(deck, shipped)
    try:
        end = follow_loop(setting, scenario_of(deck, scenario), seed)
    except CellError as fault:
        return Figures(deck.key, seed, Outcome.REFUSED, str(fault))
    known = _known(end)
    if not end.converged:
        return Figures(deck.key, seed, Outcome.REFUSED, "the loop does not converge", **known)
    return _mated(deck, seed, end, setting.recipe, sensor, commissioned, known)


def _known(end: LoopEnd) -> dict[str, Any]:
    last = end.looks[-1]
    return {
        "looks": len(end.looks),
        "off_about_weak_deg": float(np.abs(last["off_truth_mm_deg"][3:5]).max()),
        "normalised_squared": last["normalised_squared"][0],
    }


def _mated(  # noqa: PLR0917  # all that a mating needs
    deck: Deck,
    seed: int,
    end: LoopEnd,
    recipe: DeckRecipe,
    sensor: ForceSensorConfig,
    commissioned: Commissioned,
    known: dict[str, Any],
) -> Figures:
    world = end.station.world
    cell = MatingCell(
        world,
        np.random.default_rng([seed, 78]),
        M_T_D=end.M_T_D,
        flange_T_deck=end.flange_T_deck,
    )
    world.payload.peak_contact_force_n = 0.0
    try:
        plan = _plan(cell, recipe, sensor, commissioned, payload_kg(deck))
        known["speed_mm_s"] = plan.speed.speed_m_s / MM
        result, held_n = _run(cell, plan)
    except CellError as fault:
        known["peak_n"] = world.payload.peak_contact_force_n
        return Figures(deck.key, seed, Outcome.REFUSED, str(fault), **known)
    truth = world.truth_report()
    known |= {
        "lateral_mm": max(pin["offset_mm"] for pin in truth["pins"].values()),
        "gap_mm": truth["frame_T_deck_mm_deg"][2] - truth["deck_thickness_mm"],
        "peak_n": world.payload.peak_contact_force_n,
        "final_n": held_n,
    }
    if not result.verdict.seated:
        text = ", ".join(finding.value for finding in result.verdict.findings)
        return Figures(deck.key, seed, Outcome.REFUSED, text, **known)
    good = known["lateral_mm"] <= PIN_LIMIT_MM and known["peak_n"] < FORCE_LIMIT_N
    return Figures(deck.key, seed, Outcome.GOOD if good else Outcome.FALSE, **known)


def _plan(
    cell: MatingCell,
    recipe: DeckRecipe,
    sensor: ForceSensorConfig,
    commissioned: Commissioned,
    mass_kg: float,
) -> MatingPlan:
    """As the process plans it, from the pose that the loop has measured last."""
    return plan_mating(
        base_T_flange=cell.arm.encoder_pose(cell.world.time_s),
        flange_T_deck=cell.flange_T_deck,
        flange_T_sensor=cell.flange_T_sensor,
        M_T_D=cell.M_T_D,
        deck_thickness_m=recipe.deck_thickness_mm * MM,
        over_travel_m=recipe.over_travel_mm * MM,
        settings=mating_settings(sensor, recipe, commissioned, mass_kg),
    )


def _run(cell: MatingCell, plan: MatingPlan) -> tuple[MatingResult, float]:
    """The mating, and the true force at its last sign of progress while it held."""
    forces_n: list[float] = []

    def watch(progress: MatingProgress) -> None:
        if progress.phase is MatingPhase.HOLD:
            forces_n.append(cell.world.payload.contact_force_n)

    async def attempt() -> MatingResult:
        return await mate(cell.robot, cell.guard, plan, watch)

    result = run_simulated(cell.start_s, cell.advance, attempt)
    return result, forces_n[-1]
