"""Pegs that are not inserted, in the contact model: fed, pushed and judged as in a run (R4).

Search and face are left out: frame A lies where touches of the true face would put it, and the peg
stands over the hole, or where its state wants it. The cell believes its grip force, also where the
part slips with less.
"""

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import cast

import numpy as np
from scipy.spatial.transform import RigidTransform

from benchmarks.insertion.contact_guard import SensorFault
from benchmarks.insertion.contact_world import ContactWorld, Injected
from benchmarks.insertion.cycles import SENSING, CycleCell
from cellctl.cell.contact_motion.contact_loop import ContactLoop
from cellctl.cell.contact_motion.frames import ContactFrames
from cellctl.cell.contact_motion.streamed_contact import StreamedContact
from cellctl.cell.guarded_motion.guard_limits import guard_limits
from cellctl.cell.guarded_motion.guard_port import GuardPort
from cellctl.cell.guarded_motion.guarded_moves import WrenchTolerance
from cellctl.errors.base import CellError
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.peg_in_hole.cycle import feed_and_judge
from cellctl.processes.peg_in_hole.offline.curve import parse_curve
from cellctl.processes.peg_in_hole.offline.judge import judge_curve
from cellctl.processes.peg_in_hole.offline.judged_part import judged_part
from cellctl.processes.peg_in_hole.offline.task_file import JudgedPart
from cellctl.processes.peg_in_hole.plan.phases import CyclePhase, guard_force
from cellctl.processes.peg_in_hole.record.tick_log import TickLog
from cellctl.processes.peg_in_hole.run import contact_settings
from fakes.scenes.socket.part import PegPart, draw_part, nominal_fit
from fakes.world.peg.fit import Fit

_BEGIN_M = 0.4e-3
"""Height of the tip over the face at the begin."""
_WINDOW_MS = 20
"""The limit of the insertion holds for the mean over this time (R3 of the study)."""
_OVER = RigidTransform.from_matrix(np.diag([1.0, -1.0, -1.0, 1.0]))


class TrapState(StrEnum):
    """What is wrong with the peg."""

    INSERTED = "nothing"
    ON_FACE = "slips on the face"
    ON_CHAMFER = "slips on the chamfer"
    BLOCKED = "slips in a blocked hole"
    WRONG_HOLE = "in a wider hole"
    TOO_DEEP = "in a hole that is too deep"
    FROZEN = "sensor repeats a plausible value"
    STUCK = "sensor stays at a plausible value, with noise"
    WRONG_FACE = "face touched 1 mm wrong"
    SLIPS_TO_STOP = "slips in a blocked hole up to a stop in the fingers"
    ZERO_JUMPS = "zero of the sensor jumps in the feed"
    ZERO_JUMPS_AT_SEAT = "zero of the sensor jumps in the rise at the seat"


_DEAD_SENSOR = frozenset({TrapState.FROZEN, TrapState.STUCK})


@dataclass(frozen=True, slots=True)
class ContactTrap:
    """What came of one."""

    state: TrapState
    seed: int
    inserted: bool
    """What the verdict says."""
    fault: str
    seated: bool
    """True where the peg truly is at the seat of a hole as drawn."""
    by_curve: str
    """What `cellctl judge-insertion` says of the ticks, or the number of its fault."""
    force_n: float
    """Greatest true force over 20 ms."""
    limit_n: float
    """What it may be: the limit of the insertion; with a sensor that is dead, which nobody can
    measure by, that of the fault."""
    curve: str
    """Ticks, as the record of a run has them."""

    @property
    def found(self) -> tuple[str, ...]:
        """What must never happen, in words."""
        found = []
        if not self.seated and (self.inserted or self.by_curve == "inserted"):
            found.append("called inserted and is not")
        if self.force_n > self.limit_n:
            found.append(f"{self.force_n:.1f} N of {self.limit_n:g}, {self.fault or 'no fault'}")
        return tuple(found)


@dataclass(slots=True, eq=False)
class _Made:
    """How one state is made."""

    fit: Fit
    aside_m: float = 0.0
    z0_m: float = 0.0
    grip_n: float | None = None
    sensor: SensorFault | None = None
    stop_m: float | None = None
    """Way after which a slipping part meets a stop in the fingers; None without one."""


def run_contact_trap(cell: CycleCell, state: TrapState, seed: int) -> ContactTrap:
    """The same seed gives the same trap."""
    return asyncio.run(_run(cell, state, seed))


async def _run(cell: CycleCell, state: TrapState, seed: int) -> ContactTrap:
    rng = np.random.default_rng([seed, list(TrapState).index(state)])
    made = _MAKE[state](_Made(nominal_fit(cell.scenario.fit)), rng)
    world, frames = _placed(cell, made, rng, seed)
    task, log = cell.plan.task, TickLog()
    loop = ContactLoop(
        world.stream,
        cast(GuardPort, world.guard),
        world.tare(frames),
        frames,
        settings=contact_settings(cell.recipe, cell.plan, cell.settings),
        observer=log,
        clock=lambda: world.now_s,
    )
    if made.sensor is not None and made.sensor.begins_with is None:
        # The failure begins in the middle of a feed, with whatever is felt there.
        made.sensor.begins_s = world.now_s + float(rng.uniform(1.0, 8.0))

    async def begin(phase: CyclePhase, _words: str) -> None:
        tolerance = WrenchTolerance(guard_force(task, phase).value, task.limits.fault_n_m)
        await world.guard.arm(guard_limits(tolerance.limits, SENSING))

    inserted, fault = False, ""
    try:
        _, _, judgement = await feed_and_judge(StreamedContact(loop), cell.plan, 0.0, begin)
        inserted = judgement.inserted
        if judgement.fault is not None:
            fault = f"F{judgement.fault.number}"
    except CellError as raised:
        fault = f"F{raised.number}"
    by_curve = _judged(log.text(), judged_part(cell.recipe, cell.plan, 0.0))
    return ContactTrap(
        state,
        seed,
        inserted,
        fault,
        world.seated,
        by_curve,
        round(world.peaks.force_n[_WINDOW_MS], 2),
        task.limits.fault_n if state in _DEAD_SENSOR else task.limits.insertion_n,
        log.text(),
    )


def _judged(curve: str, part: JudgedPart) -> str:
    try:
        return judge_curve(parse_curve(curve.encode()), part)[1].verdict.value
    except CellError as fault:
        return f"F{fault.number}"


def _placed(
    cell: CycleCell, made: _Made, rng: np.random.Generator, seed: int
) -> tuple[ContactWorld, ContactFrames]:
    """The world with the peg over its place, and frame A on the face that was touched."""
    scenario = cell.scenario
    part = draw_part(scenario, seed, 1)
    flange_T_tip = pose_from_xyzabc(cell.recipe.flange_T_tip)
    azimuth = float(rng.uniform(0, 2 * np.pi))
    x_m, y_m = made.aside_m * np.cos(azimuth), made.aside_m * np.sin(azimuth)
    # Where the true tip is to stand; the part sits in the fingers as it was drawn.
    height = RigidTransform.from_translation([x_m, y_m, _BEGIN_M])
    base_T_flange = _upright(part, flange_T_tip, height)
    # Touches of the face meet it with the true tip, and so does frame A: how deep the part sits in
    # the fingers has gone into it.
    base_T_face = part.cell_T_hole * _OVER
    tip, true_tip = (base_T_flange * one for one in (flange_T_tip, part.flange_T_peg))
    grip_m = base_T_face.rotation.inv().apply(tip.translation - true_tip.translation)[2]
    base_T_task = base_T_face * RigidTransform.from_translation([0, 0, grip_m + made.z0_m])
    world = ContactWorld(
        scenario,
        part,
        base_T_flange,
        cell.imperfections,
        np.random.default_rng([seed, 7]),
        injected=Injected(made.fit, made.grip_n, made.sensor, made.stop_m),
    )
    task_T_tip = base_T_task.inv() * base_T_flange * flange_T_tip
    return world, ContactFrames(base_T_task, flange_T_tip, task_T_tip.rotation)


def _upright(part: PegPart, flange_T_tip: RigidTransform, height: RigidTransform) -> RigidTransform:
    """The flange that stands square on the face, with the true tip at its place."""
    square = part.cell_T_hole * height * _OVER * flange_T_tip.inv()
    tip = (square * part.flange_T_peg).translation
    wanted = (part.cell_T_hole * height).translation
    return RigidTransform.from_translation(wanted - tip) * square


def _as_drawn(made: _Made, _rng: np.random.Generator) -> _Made:
    return made


def _on_face(made: _Made, rng: np.random.Generator) -> _Made:
    catch_m = made.fit.mouth_radius_m - made.fit.rim_radius_m
    made.aside_m = catch_m + float(rng.uniform(0.3e-3, 3e-3))
    return _slipping(made, rng)


def _on_chamfer(made: _Made, rng: np.random.Generator) -> _Made:
    catch_m = made.fit.mouth_radius_m - made.fit.rim_radius_m
    made.aside_m = float(rng.uniform(made.fit.clearance_m + 0.1e-3, catch_m))
    return _slipping(made, rng)


def _blocked(made: _Made, rng: np.random.Generator) -> _Made:
    made.fit = replace(made.fit, depth_m=made.fit.depth_m * float(rng.uniform(0.2, 0.9)))
    return _slipping(made, rng)


def _slipping(made: _Made, rng: np.random.Generator) -> _Made:
    # Less than what the cell presses with at the end of a feed, and than what it believes.
    made.grip_n = float(rng.uniform(4.0, 25.0))
    return made


def _wider(made: _Made, rng: np.random.Generator) -> _Made:
    wider_m = float(rng.uniform(0.1e-3, 0.3e-3))
    made.fit = replace(made.fit, bore_radius_m=made.fit.bore_radius_m + wider_m)
    return made


def _too_deep(made: _Made, rng: np.random.Generator) -> _Made:
    made.fit = replace(made.fit, depth_m=made.fit.depth_m + float(rng.uniform(0.5e-3, 3e-3)))
    return made


def _frozen(made: _Made, _rng: np.random.Generator) -> _Made:
    made.sensor = SensorFault(lambda _sample, last: last)
    return made


def _stuck(made: _Made, rng: np.random.Generator) -> _Made:
    sigma = np.array([0.1, 0.1, 0.1, 0.003, 0.003, 0.003])
    made.sensor = SensorFault(lambda _sample, last: last + rng.normal(0.0, sigma))
    return made


def _slipping_to_stop(made: _Made, rng: np.random.Generator) -> _Made:
    """The part ends short of its seat by as much as it slips, and stands there as on a seat."""
    made.stop_m = float(rng.uniform(0.5e-3, 0.7 * made.fit.depth_m))
    made.fit = replace(made.fit, depth_m=made.fit.depth_m - made.stop_m)
    # Less would slip in a search, and more than the feed pushes with does not slip.
    made.grip_n = float(rng.uniform(5.0, 15.0))
    return made


def _zero_jumps(made: _Made, rng: np.random.Generator) -> _Made:
    jump_n = float(rng.uniform(5.0, 20.0)) * float(rng.choice([-1.0, 1.0]))
    jump = np.array([0.0, 0.0, jump_n, 0.0, 0.0, 0.0])
    made.sensor = SensorFault(lambda sample, _last: sample + jump)
    return made


def _zero_jumps_at_seat(made: _Made, rng: np.random.Generator) -> _Made:
    """In the rise, where the force that it takes away may hide behind what is felt."""
    begins_n = float(rng.uniform(6.0, 17.0))
    # By more, and it would act with the feed; by less, and it would not matter.
    jump_n = float(rng.uniform(0.8, 1.0)) * begins_n
    jump = np.array([0.0, 0.0, jump_n, 0.0, 0.0, 0.0])
    made.sensor = SensorFault(
        lambda sample, _last: sample + jump, begins_with=lambda sample: -sample[2] > begins_n
    )
    return made


def _wrong_face(made: _Made, rng: np.random.Generator) -> _Made:
    made.z0_m = 1e-3 * float(rng.choice([-1.0, 1.0]))
    return made


_MAKE: Mapping[TrapState, Callable[[_Made, np.random.Generator], _Made]] = {
    TrapState.INSERTED: _as_drawn,
    TrapState.ON_FACE: _on_face,
    TrapState.ON_CHAMFER: _on_chamfer,
    TrapState.BLOCKED: _blocked,
    TrapState.WRONG_HOLE: _wider,
    TrapState.TOO_DEEP: _too_deep,
    TrapState.FROZEN: _frozen,
    TrapState.STUCK: _stuck,
    TrapState.WRONG_FACE: _wrong_face,
    TrapState.SLIPS_TO_STOP: _slipping_to_stop,
    TrapState.ZERO_JUMPS: _zero_jumps,
    TrapState.ZERO_JUMPS_AT_SEAT: _zero_jumps_at_seat,
}
