"""One whole cycle over the contact model, from the face to the way out, held against the truth.

Recipe, plan, searches, insertion and verdict are those of the daemon, with the loop that was
measured; see ``contact_world`` for what is simpler than on the wire.
"""

import asyncio
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, Self, cast

import numpy as np

from benchmarks.insertion.contact_world import ContactWorld, Imperfections, Injected
from cellctl.calibration.store.store import CalibrationStore
from cellctl.cell.contact_motion.contact_loop import ContactLoop
from cellctl.cell.contact_motion.frames import ContactFrames
from cellctl.cell.contact_motion.streamed_contact import StreamedContact
from cellctl.cell.guarded_motion.guard_limits import Sensing, guard_limits
from cellctl.cell.guarded_motion.guard_port import GuardPort
from cellctl.cell.guarded_motion.guarded_moves import WrenchTolerance
from cellctl.clock import utc_now
from cellctl.config.load import load_cell
from cellctl.errors.base import CellError
from cellctl.processes.peg_in_hole.calibrations import CALIBRATIONS, CONTACT_LOOP
from cellctl.processes.peg_in_hole.cycle import CycleLog, CyclePlan, search_and_insert
from cellctl.processes.peg_in_hole.facts import with_measured
from cellctl.processes.peg_in_hole.offline.judged_part import judged_part
from cellctl.processes.peg_in_hole.offline.task_file import JudgedPart
from cellctl.processes.peg_in_hole.plan.cycle_plan import cycle_plan
from cellctl.processes.peg_in_hole.plan.phases import CyclePhase, guard_force
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.record.tick_log import TickLog
from cellctl.processes.peg_in_hole.run import contact_settings
from cellctl.processes.peg_in_hole.search.face import CLEAR_M, touch_face
from cellctl.processes.peg_in_hole.settings import PegSettings
from cellctl.processes.peg_in_hole.stations import believed_frames, on_face, peg_recipes
from cellctl.processes.peg_in_hole.steps.backing_out import back_out_after
from fakes.scenes.socket.part import PegPart, draw_part
from fakes.scenes.socket.peaks import ForcePeaks
from fakes.scenes.socket.scenario import SocketScenario
from fakes.world.frames import from_written

CONFIG = Path(__file__).parents[2] / "config"
SENSING = Sensing(1000.0, 0.01, 0.1)


@dataclass(frozen=True, slots=True, eq=False)
class CycleCell:
    """A shipped cell of fakes, and the plan for it."""

    scenario: SocketScenario
    recipe: PegRecipe
    settings: PegSettings
    plan: CyclePlan

    @classmethod
    def shipped(cls, name: str) -> "CycleCell":
        """``insertion-NAME.toml`` with its scenario and with the loop that was measured."""
        file = CONFIG / f"insertion-{name}.toml"
        config = load_cell(file)
        (recipe,) = peg_recipes(config)
        kind = CONTACT_LOOP.for_recipe(recipe.id)
        store = CalibrationStore(CONFIG / str(config.calibration_dir), CALIBRATIONS)
        figures = store.read_all([kind], utc_now()).find(kind)
        settings = cast(PegSettings, config.processes[recipe.process])
        # Allowances of the fake cell for a busy PC; here no PC is late.
        prompt = {"lost_tick_ms": None, "old_force_ms": 5.0, "lost_force_ms": 20.0}
        settings = with_measured(settings.model_copy(update=prompt), figures)
        scenario = SocketScenario.read(file.with_suffix(".scenario.toml"))
        return cls(scenario, recipe, settings, cycle_plan(recipe, settings))

    @classmethod
    def told(
        cls, scenario: SocketScenario, recipe: Mapping[str, Any], settings: Mapping[str, Any]
    ) -> Self:
        """A cell by its written keys. Raises what refuses a recipe before any motion."""
        told, known = PegRecipe.model_validate(recipe), PegSettings.model_validate(settings)
        plan = cycle_plan(told, known)
        contact_settings(told, plan, known).check()
        return cls(scenario, told, known, plan)

    @property
    def imperfections(self) -> Imperfections:
        """Imperfections of its arm, as the task states them, and of its sensor."""
        stated = self.plan.task.cell
        sensor = self.scenario.force_sensors[self.scenario.peg.force_sensor]
        return Imperfections(
            stated.repeatability_m, stated.height_sigma_m, sensor.noise_n, sensor.noise_nm
        )


@dataclass(slots=True, eq=False)
class CycleOutcome:
    """What came of one cycle."""

    seed: int
    called_good: bool = False
    seated: bool = False
    """True where the peg truly was at its seat when the cell gave its verdict or its fault."""
    fault: str = ""
    search_s: float = float("nan")
    cycle_s: float = 0.0
    peaks: dict[CyclePhase, ForcePeaks] = field(default_factory=dict)
    """True forces of each phase."""
    height_m: float = 0.0
    """Height of the peg's tip over the face at the end."""
    curve: str = ""
    """Ticks from the face on, as the record of a run has them."""
    part: JudgedPart | None = None
    """What the record says to whoever judges the curve later."""
    unsolved_share: float = 0.0
    """Share of the steps in contact in which the model found no equilibrium."""

    def peak_n(self, phase: CyclePhase, window_ms: int) -> float:
        """0 for a phase that was not reached."""
        return self.peaks[phase].force_n[window_ms] if phase in self.peaks else 0.0


@dataclass(frozen=True, slots=True, eq=False)
class CycleInjection:
    """What is wrong with one cycle."""

    world: Injected = field(default_factory=Injected)
    part: PegPart | None = None
    """Another than the one that the seed draws."""
    sensor_from: CyclePhase | None = None
    """The sensor's fault begins so long after the first begin of this phase."""
    sensor_delay_s: float = 0.0


def run_cycle(cell: CycleCell, seed: int, injection: CycleInjection | None = None) -> CycleOutcome:
    """The same seed gives the same part, hole and noise."""
    return asyncio.run(_Cycle(cell, seed, injection or CycleInjection()).run())


class _Cycle:
    def __init__(self, cell: CycleCell, seed: int, injection: CycleInjection) -> None:
        self._cell, self._outcome, self._injection = cell, CycleOutcome(seed), injection
        scenario = cell.scenario
        self._above = from_written(scenario.taught[scenario.peg.carried_by]["above_hole"])
        self._world = ContactWorld(
            scenario,
            injection.part or draw_part(scenario, seed, 1),
            self._above,
            cell.imperfections,
            np.random.default_rng([seed, 7]),
            injected=injection.world,
        )
        self.ticks = TickLog()

    async def run(self) -> CycleOutcome:
        world, outcome = self._world, self._outcome
        begun_s = world.now_s
        try:
            await self._insert()
        except CellError as fault:
            outcome.fault = f"F{fault.number}"
        outcome.cycle_s = world.now_s - begun_s
        outcome.unsolved_share = world.peg.unsolved_share
        outcome.height_m = float(world.peg.pose[2])
        return outcome

    async def _insert(self) -> None:
        plan, outcome = self._cell.plan, self._outcome
        frames = believed_frames(self._cell.recipe, self._above)
        motions = self._motions(frames)
        await self._begin(motions, CyclePhase.FACE)
        face = await touch_face(motions, plan.task, plan.face)
        await motions.back_out(CLEAR_M - face.depth_m + plan.face.radius_m * face.tilt_rad)
        outcome.part = judged_part(self._cell.recipe, plan, face.yields_m)
        self.ticks = TickLog()
        motions = self._motions(on_face(frames, face))
        try:
            begin = partial(self._begin, motions)
            result = await search_and_insert(motions, plan, face.yields_m, CycleLog.of(plan), begin)
            outcome.seated = self._world.seated
            if result.judgement.fault is not None:
                raise result.judgement.fault
            outcome.called_good = True
        except CellError as fault:
            outcome.seated = self._world.seated
            outcome.fault = f"F{fault.number}"
            await back_out_after(fault, motions)
        finally:
            outcome.curve = self.ticks.text()

    async def _begin(self, motions: StreamedContact, phase: CyclePhase, _words: str = "") -> None:
        world, outcome, task = self._world, self._outcome, self._cell.plan.task
        if phase is CyclePhase.SEARCH and phase not in outcome.peaks:
            outcome.search_s = -world.now_s
        fault, injection = self._injection.world.sensor, self._injection
        if fault is not None and phase is injection.sensor_from and np.isinf(fault.begins_s):
            fault.begins_s = world.now_s + injection.sensor_delay_s
        if phase is CyclePhase.INSERTION:
            outcome.search_s += world.now_s
        tolerance = WrenchTolerance(guard_force(task, phase).value, task.limits.fault_n_m)
        await world.guard.arm(guard_limits(tolerance.limits, SENSING))
        motions.watched_n = tolerance.force_n
        world.peaks = outcome.peaks.setdefault(phase, ForcePeaks())

    def _motions(self, frames: ContactFrames) -> StreamedContact:
        world, cell = self._world, self._cell
        tare = world.tare(frames)
        loop = ContactLoop(
            world.stream,
            cast(GuardPort, world.guard),
            tare,
            frames,
            settings=contact_settings(cell.recipe, cell.plan, cell.settings),
            observer=self.ticks,
            clock=lambda: world.now_s,
        )
        return StreamedContact(loop)
