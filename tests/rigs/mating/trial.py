"""One trial of the campaign: a drawn cell, one mating, what came of it against truth."""

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from cellctl.errors.base import CellError
from cellctl.force.contact.curve import moving_average
from cellctl.processes.deck_to_frame.mating.mate import mate
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan, plan_mating
from cellctl.processes.deck_to_frame.mating.result import MatingPhase, MatingProgress, MatingResult
from cellctl.processes.deck_to_frame.mating.settings import MatingSettings
from fakes.scenes.deck_on_frame.scenario import Pins
from tests.rigs.mating.cell import MatingCell
from tests.rigs.mating.seat_truth import seat_truth
from tests.rigs.mating.simulated_loop import run_simulated

ARM_STIFFNESS_N_M = 1e6
STIFFEST_CONTACT_N_M = 1e7
STIFFNESS_RANGE = (1e5, 1e7)
LATENCY_RANGE_S = (0.010, 0.250)
DECK_THICKNESS_M = 0.015
SEAT_TOLERANCE_M = 1e-4
PIN_LIMIT_MM = 0.2
"""What a seated deck may lie beside its place at the pin holes."""
FILTER_SAMPLES = 20
"""A lateral peak is that of the mean over 20 ms: two noisy components only add up."""

PINS = Pins(
    length_mm=1.2,
    radius_mm=3.0,
    clearance_mm=0.03,
    chamfer_mm=0.8,
    chamfer_deg=45.0,
    stiffness_n_m=2e7,
)
"""What the campaign of pins and its tests have on the frame."""

Hook = Callable[[MatingCell, MatingProgress], None]


@dataclass(slots=True)
class Trial:
    """Figures of one trial; forces in N, lengths in mm."""

    name: str
    seed: int
    stiffness_n_m: float
    stop_latency_ms: float
    outcome: str = ""
    """``seated``, ``false seat`` or the number of the fault."""
    text: str = ""
    true_peak_n: float = 0.0
    sensed_peak_n: float = 0.0
    sensed_filtered_peak_n: float = 0.0
    final_true_n: float = float("nan")
    final_sensed_n: float = float("nan")
    judged_gap_mm: float = float("nan")
    """What the verdict took for the gap."""
    true_gap_mm: float = float("nan")
    """Gap of the deck's middle over its seat while holding, less what the seat gives way."""
    true_opening_mm: float = float("nan")
    """Greatest distance between deck and seat meanwhile."""
    true_pin_error_mm: float = float("nan")
    """Greatest distance of a pin from the axis of its hole meanwhile."""
    speed_mm_s: float = 0.0
    slow_s: float = 0.0
    duration_s: float = 0.0
    steps: int = 0
    end_travel_mm: float = float("nan")
    reached_mm: float = 0.0
    peak_lateral_n: float = 0.0
    final_lateral_n: float = float("nan")
    gave_way_mm: float = 0.0
    """How far the deck gave way across the approach, because of pins."""
    standing: bool = False
    """The arm stands still at the end."""

    @property
    def complete(self) -> bool:
        """The mating said that it is complete."""
        return self.outcome == "seated"

    @property
    def false_complete(self) -> bool:
        """It said so, and truth disagrees."""
        # Each says what a good seat is, so that what is not a number is a false one.
        good = (
            35.0 <= self.final_true_n <= 45.0
            and abs(self.true_gap_mm) <= 1e3 * SEAT_TOLERANCE_M
            and self.true_pin_error_mm <= PIN_LIMIT_MM
        )
        return self.complete and not good

    def row(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)


@dataclass(slots=True)
class _Watcher:
    """Follows the progress of a mating with the eyes of truth."""

    cell: MatingCell
    trial: Trial
    hook: Hook | None
    slow: list[float] = field(default_factory=list)

    def __call__(self, progress: MatingProgress) -> None:
        time_s = asyncio.get_running_loop().time()
        if progress.phase is MatingPhase.SLOW or (self.slow and len(self.slow) == 1):
            self.slow = [self.slow[0] if self.slow else time_s]
        if progress.phase is MatingPhase.CREEP and len(self.slow) == 1:
            self.slow.append(time_s)
        if progress.phase is MatingPhase.HOLD:
            self._hold()
        if progress.curve is not None and len(progress.curve.wrench):
            self.trial.sensed_peak_n = float(progress.curve.wrench[:, 2].max())
            lateral_n = np.hypot(*progress.curve.wrench[:, :2].T)
            self.trial.peak_lateral_n = float(moving_average(lateral_n, FILTER_SAMPLES).max())
            self.trial.reached_mm = float(np.nanmax(progress.curve.travel_m)) * 1e3
        if self.hook is not None:
            self.hook(self.cell, progress)

    def _hold(self) -> None:
        world, trial = self.cell.world, self.trial
        trial.final_true_n = world.payload.contact_force_n
        truth = seat_truth(world, self.cell.true_pose())
        trial.true_gap_mm, trial.true_opening_mm = truth.gap_mm, truth.opening_mm
        trial.true_pin_error_mm = truth.pin_error_mm


def draw_trial(seed: int) -> Trial:
    """Stiffness and latency of a seed, log-uniform over their ranges."""
    rng = np.random.default_rng([seed, 5])
    stiffness = float(np.exp(rng.uniform(*np.log(STIFFNESS_RANGE))))
    latency_s = float(np.exp(rng.uniform(*np.log(LATENCY_RANGE_S))))
    return Trial("mating", seed, stiffness, latency_s * 1e3)


def run_trial(
    trial: Trial,
    hook: Hook | None = None,
    prepare: Callable[[MatingCell], None] | None = None,
    special: Mapping[str, Any] = MappingProxyType({}),
    **settings: Any,
) -> Trial:
    """Run it; ``hook`` sees every progress and may inject, ``prepare`` changes the cell before.

    ``special``: further arguments of the cell; ``settings``: of the mating.
    """
    latency_s = trial.stop_latency_ms / 1e3
    cell = MatingCell.drawn(
        trial.seed, stiffness_n_m=trial.stiffness_n_m, stop_latency_s=latency_s, **special
    )
    if prepare is not None:
        prepare(cell)
    watcher = _Watcher(cell, trial, hook)
    chosen = replace(nominal_settings(latency_s), **settings)
    plan = plan_for(cell, chosen)
    trial.speed_mm_s = plan.speed.speed_m_s * 1e3

    async def attempt() -> MatingResult:
        return await mate(cell.robot, cell.guard, plan, watcher)

    try:
        result = run_simulated(cell.start_s, cell.advance, attempt)
    except CellError as fault:
        trial.outcome, trial.text = f"F{fault.number}", str(fault)
        trial.text += "".join(f"; {note}" for note in getattr(fault, "__notes__", ()))
    else:
        _take_result(trial, result)
    world = cell.world
    trial.true_peak_n = world.payload.peak_contact_force_n
    trial.end_travel_mm = plan.travel_of(cell.arm.encoder_pose(world.time_s)) * 1e3
    trial.standing = not cell.arm.moving(world.time_s)
    trial.slow_s = watcher.slow[1] - watcher.slow[0] if len(watcher.slow) == 2 else float("nan")
    trial.duration_s = world.time_s - cell.start_s
    return trial


def nominal_settings(stop_latency_s: float) -> MatingSettings:
    """Settings after commissioning: measured latency, stiffness only bounded from above."""
    return MatingSettings(
        stop_latency_s=1.05 * stop_latency_s + 0.01,
        stiffness_n_m=1.0 / (1.0 / ARM_STIFFNESS_N_M + 1.0 / STIFFEST_CONTACT_N_M),
    )


def plan_for(cell: MatingCell, settings: MatingSettings) -> MatingPlan:
    """The plan from what vision and calibration say about the cell."""
    return plan_mating(
        base_T_flange=cell.arm.encoder_pose(cell.world.time_s),
        flange_T_deck=cell.flange_T_deck,
        flange_T_sensor=cell.flange_T_sensor,
        M_T_D=cell.M_T_D,
        deck_thickness_m=DECK_THICKNESS_M,
        over_travel_m=0.010,
        settings=settings,
    )


def _take_result(trial: Trial, result: MatingResult) -> None:
    trial.outcome = result.outcome.value
    trial.final_sensed_n = result.verdict.force_n
    trial.judged_gap_mm = result.verdict.gap_m * 1e3
    trial.sensed_filtered_peak_n = result.statistics.peak_filtered_fz_n
    trial.steps = len(result.creep) - 1
    trial.final_lateral_n = result.verdict.lateral_n
    if result.gave_way:
        trial.gave_way_mm = result.gave_way[-1].total.distance_m * 1e3
    trial.text = ", ".join(finding.value for finding in result.verdict.findings)
