"""Pegs that a test of depth accepts, though most of them are not inserted (R4).

In every state but one the part has slipped in the gripper, so that the robot stands where it would
stand with an inserted peg. What a push to the side meets follows from the state.
"""

import asyncio
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from cellctl.cell.contact_motion.motions import Condition, ContactMotion, Ended
from cellctl.processes.peg_in_hole.plan.task import SearchTask
from cellctl.processes.peg_in_hole.verdict.evidence import InsertionEvidence
from cellctl.processes.peg_in_hole.verdict.judgement import PegJudgement, PegSeatLimits, judge_peg
from cellctl.processes.peg_in_hole.verdict.lateral import measure_capture
from tests.rigs.insertion.kinematic import KinematicMotions
from tests.rigs.insertion.surface import Truth

Array = NDArray[np.float64]

SEAT = PegSeatLimits(least_n=5.0, most_n=30.0)
_WIDER_M = 0.15e-3
_FAR_M = 10e-3
_Z0_WRONG_M = 1e-3
_GRIP_N = 40.0
_ENCODER_SIGMA_M = 2e-6
_DEPTH_SIGMA_M = 0.05e-3


class PegState(StrEnum):
    """Where the peg truly is."""

    INSERTED = "inserted"
    ON_FACE = "slipped on the face"
    ON_CHAMFER = "slipped on the chamfer"
    BLOCKED = "slipped in a blocked hole"
    WRONG_HOLE = "in a wider hole"
    TOO_DEEP = "in a hole that is too deep"
    FROZEN = "sensor frozen"
    WRONG_FACE = "face touched 1 mm wrong"


_SLIPPED = {PegState.ON_FACE, PegState.ON_CHAMFER, PegState.BLOCKED}


class StandingPeg(KinematicMotions):
    """A peg in one state, pushed to its sides."""

    def __init__(self, task: SearchTask, state: PegState, rng: np.random.Generator) -> None:
        super().__init__(task, Truth(np.zeros(2), np.zeros(2)), rng)
        self._state = state
        self._noise_of = rng
        half_m = task.fit.clearance_m + (_WIDER_M if state is PegState.WRONG_HOLE else 0.0)
        # Bounds of the tip: rows x and y, below and above; far away where nothing stands.
        self._walls: Array = np.array([[-half_m, half_m], [-half_m, half_m]])
        if state is PegState.ON_FACE:
            self._walls = np.array([[-_FAR_M, _FAR_M], [-_FAR_M, _FAR_M]])
        if state is PegState.ON_CHAMFER:
            # It leans on the slope, which stands at one side of each axis only.
            for axis in (0, 1):
                side = int(rng.integers(2))
                self._walls[axis, side] = _FAR_M if side else -_FAR_M
        self.position_m = np.array([0.0, 0.0, task.fit.depth_m])
        self._frozen_n = rng.normal(0, task.cell.force_sigma_n, 3)

    async def press(
        self,
        force_n: float,
        hold_s: float,
        until: Condition | None = None,
    ) -> ContactMotion:
        self.time_s += hold_s
        return self._answer(Ended.TIME, np.array([0.0, 0.0, -force_n]))

    async def touch(
        self,
        direction: Array,
        travel_m: float,
        force_n: float,
        speed_m_s: float | None = None,
        until: Condition | None = None,
    ) -> ContactMotion:
        axis, sign = int(np.argmax(np.abs(direction))), float(np.sum(direction))
        wall_m = self._walls[axis, 1 if sign > 0 else 0]
        yields_m = force_n / self.task.cell.stiffness_n_m
        gap_m = (wall_m - self.position_m[axis]) * sign + yields_m
        gap_m += float(self._noise_of.normal(0, _ENCODER_SIGMA_M))
        if self._state is PegState.FROZEN:
            # Nothing ends the push, and the arm goes on by its encoders.
            gap_m = travel_m + _ENCODER_SIGMA_M
        met = gap_m <= travel_m
        self.position_m = self.position_m + min(gap_m, travel_m) * direction
        if met and self._state is PegState.ON_CHAMFER:
            # The slope lifts a peg that is pushed against it.
            self.position_m[2] -= 0.5 * abs(gap_m) + 0.05e-3
        friction_n = 2.0 * self.task.cell.friction
        felt_n = force_n if met else friction_n
        return self._answer(Ended.FORCE if met else Ended.TRAVEL, -felt_n * direction)

    def _answer(self, ended: Ended, force_n: Array) -> ContactMotion:
        sample = self._sample(0.0)
        felt = self._frozen_n if self._state is PegState.FROZEN else sample.force_n + force_n
        sample.force_n[:] = felt
        return ContactMotion(ended, (sample,))


@dataclass(frozen=True, slots=True)
class TrapOutcome:
    """What the verdict says of one state."""

    state: PegState
    judgement: PegJudgement
    captured: bool
    """Whether the pushes alone call the peg captured."""


def run_trap(task: SearchTask, state: PegState, seed: int) -> TrapOutcome:
    """Evidence as a robot would find it; every second slipped part is not touched from behind."""
    rng = np.random.default_rng([seed, list(PegState).index(state)])
    capture = asyncio.run(measure_capture(StandingPeg(task, state, rng), task))
    depth_m = task.fit.depth_m + float(rng.normal(0, _DEPTH_SIGMA_M))
    if state is PegState.WRONG_FACE:
        depth_m += _Z0_WRONG_M * float(rng.choice([-1, 1]))
    if state is PegState.TOO_DEEP:
        depth_m += float(rng.uniform(0.5e-3, 3e-3))
    slipped = state in _SLIPPED
    greatest_n = _GRIP_N * float(rng.uniform(1.0, 1.2)) if slipped else float(rng.uniform(8, 20))
    shallow_m = float(rng.uniform(0.5e-3, task.fit.depth_m)) if slipped else 0.0
    retouched = not slipped or seed % 2 == 0
    evidence = InsertionEvidence(
        depth_m=depth_m,
        seat_force_n=float(rng.uniform(8, 20)),
        seat_slope_n_m=task.cell.stiffness_n_m * float(rng.uniform(0.6, 1.0)),
        # Slips that nothing on the way tells of.
        held_way_m=0.0,
        unrubbed_way_m=None,
        with_feed_n=0.0,
        dropped_n=0.0,
        capture=capture,
        greatest_force_n=greatest_n,
        grip_force_n=_GRIP_N,
        retouch_error_m=-shallow_m + float(rng.normal(0, 0.03e-3)) if retouched else None,
    )
    judgement = judge_peg(evidence, task, SEAT)
    captured = all(check.passed for check in judgement.checks[6:10])
    return TrapOutcome(state, judgement, captured)
