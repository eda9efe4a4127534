"""One deck, one seed: measured and corrected until the loop says so, then mated, in one world.

There is no wire and no clock: the mating is that of `benchmarks.mating`, but it begins with the
deck where the loop has left it, and with the pose and the uncertainty that the loop has found.
"""

from collections.abc import Callable
from dataclasses import asdict, dataclass, field, replace
from enum import StrEnum
from typing import Any, Self

import numpy as np

from benchmarks.decks.deck_range import Deck, payload_kg, scenario_of, setting_of
from benchmarks.metrology.fake_station import SCENARIO
from benchmarks.metrology.loop import CONFIG, LoopEnd, Setting, follow_loop
from cellctl.config.devices import ForceSensorConfig
from cellctl.config.load import load_cell
from cellctl.errors.base import CellError
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.commissioned_contact import Commissioned
from cellctl.processes.deck_to_frame.mating.mate import mate
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan
from cellctl.processes.deck_to_frame.mating.planned_settings import mating_settings
from cellctl.processes.deck_to_frame.mating.result import MatingPhase, MatingProgress, MatingResult
from cellctl.processes.deck_to_frame.mating.settings import MatingSettings
from cellctl.processes.deck_to_frame.poses.part_measurer import deck_in_frame
from cellctl.processes.deck_to_frame.poses.seat_error import seat_error
from cellctl.processes.deck_to_frame.steps.verify import unproven_seat
from cellctl.version import software as software_name
from fakes.demo.processes.deck_to_frame import LIMITED
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from tests.rigs.mating.cell import MatingCell
from tests.rigs.mating.simulated_loop import run_simulated
from tests.rigs.mating.trial import plan_for


class Outcome(StrEnum):
    """How a deck ended."""

    GOOD = "good"
    REFUSED = "refused"
    """The loop, the plan or the mating refused with a fault; nothing was called good."""
    FALSE = "called good, is not"


@dataclass(frozen=True, slots=True)
class Figures:
    """Truth at the end; mm, degrees and N. None where the deck did not get so far."""

    deck: str
    seed: int
    outcome: Outcome
    text: str = ""
    looks: int | None = None
    off_tilt_deg: float | None = None
    """Error of the last look: the worse one of the rotations about x and y."""
    normalised_squared: float | None = None
    speed_mm_s: float | None = None
    lateral_mm: float | None = None
    """The worst pin hole."""
    gap_mm: float | None = None
    peak_n: float | None = None
    held_n: float | None = None
    software: str = field(default_factory=software_name)
    """What was tried, with its revision."""

    @property
    def beyond(self) -> bool:
        """True where the error is more than the demonstration lets a good part have."""
        true = {
            "lateral_mm": self.lateral_mm,
            "seat_gap_mm": self.gap_mm,
            "peak_true_n": self.peak_n,
        }
        return not all(one.within(true[one.key]) for one in LIMITED if one.key in true)

    def row(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)

    @classmethod
    def of(cls, row: dict[str, Any]) -> Self:
        """The figures of a row that was read from a file."""
        return cls(**{**row, "outcome": Outcome(row["outcome"])})


@dataclass(frozen=True, slots=True, eq=False)
class Shipped:
    """The demonstration's cell, of which every deck gets a variant."""

    setting: Setting
    sensor: ForceSensorConfig
    scenario: DeckScenario

    @classmethod
    def read(cls) -> Self:
        """Read what config/ says."""
        sensor = load_cell(CONFIG / "deck.toml").force_sensors["force"]
        return cls(Setting.shipped(), sensor, DeckScenario.read(SCENARIO))


def run_chain(deck: Deck, shipped: Shipped, seed: int) -> Figures:
    """Draw a cell for the deck and assemble it."""
    setting = setting_of(deck, shipped.setting)
    try:
        end = follow_loop(setting, scenario_of(deck, shipped.scenario), seed)
    except CellError as fault:
        return Figures(deck.key, seed, Outcome.REFUSED, str(fault))
    last = end.looks[-1]
    known = Figures(
        deck.key,
        seed,
        Outcome.REFUSED,
        "the loop does not converge",
        looks=len(end.looks),
        off_tilt_deg=float(np.abs(last["off_truth_mm_deg"][3:5]).max()),
        normalised_squared=last["normalised_squared"][0],
    )
    if not end.converged:
        return known
    cell = MatingCell(
        end.station.world,
        np.random.default_rng([seed, 78]),
        M_T_D=end.M_T_D,
        flange_T_deck=end.flange_T_deck,
    )
    # Nothing was commissioned: the recipe's bounds count, as on a new cell.
    settings = mating_settings(shipped.sensor, setting.recipe, Commissioned(), payload_kg(deck))
    return _mated(cell, settings, known, lambda: _unproven(end, setting))


def _mated(
    cell: MatingCell, settings: MatingSettings, known: Figures, unproven: Callable[[], str]
) -> Figures:
    payload = cell.world.payload
    payload.peak_contact_force_n = 0.0
    try:
        plan = plan_for(cell, settings)
        known = replace(known, speed_mm_s=plan.speed.speed_m_s / MM)
        result, held_n = _run(cell, plan)
    except CellError as fault:
        return replace(known, text=str(fault), peak_n=payload.peak_contact_force_n)
    truth = cell.world.truth_report()
    known = replace(
        known,
        lateral_mm=max(pin["offset_mm"] for pin in truth["pins"].values()),
        gap_mm=truth["frame_T_deck_mm_deg"][2] - truth["deck_thickness_mm"],
        peak_n=payload.peak_contact_force_n,
        held_n=held_n,
        text=", ".join(finding.value for finding in result.verdict.findings),
    )
    if not result.verdict.seated:
        return known
    if why := unproven():
        return replace(known, text=why)
    return replace(known, outcome=Outcome.FALSE if known.beyond else Outcome.GOOD)


def _unproven(end: LoopEnd, setting: Setting) -> str:
    """What a look at the seated deck does not prove, judged as step 60 of a run does it; empty for
    a part that is called good. As there, a second look takes all frames."""
    recipe, settings = setting.recipe, setting.recipe.pose_correction
    thickness_m = recipe.deck_thickness_mm * MM
    found: list[str] = []
    for frames in (settings.frames, settings.max_frames):
        predicted = setting.base_T_c1.pose.inv() * end.station.base_T_flange() * end.flange_T_deck
        more = settings.model_copy(update={"frames": frames})
        deck, _ = end.station.measure(setting.deck, predicted, more, setting.thresholds)
        M_T_D = deck_in_frame(end.frame, deck, setting.geometry, settings.method).cautious
        seat = seat_error(M_T_D, thickness_m, setting.deck.holes)
        if not (found := list(unproven_seat(seat, recipe))):
            break
    return "; ".join(found)


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
