"""Recorded insertions as any cell could have made them, sample by sample, from a few figures."""

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NAMES = (
    "time_s", "x_mm", "y_mm", "depth_mm", "fx_n", "fy_n", "fz_n", "mx_nm", "my_nm", "mz_nm",
)  # fmt: skip
"""Columns as the record of a run has them."""
TASK = """
[fit]
peg_radius_mm = 3.0
clearance_mm = 0.05
depth_mm = 12.0
[seat]
least_n = 5.0
most_n = 30.0
grip_n = 60.0
[cell]
stiffness_n_mm = 100.0
force_sigma_n = 0.1
"""
"""The part and cell of ``Inserted()``, as a task file says them."""
_PRESS_N, _FRICTION_N = 2.0, 0.4


@dataclass(frozen=True, slots=True)
class Inserted:
    """What was done to the peg, and what it met; mm, N, N/mm and s."""

    stiffness_n_mm: float = 100.0
    hole_mm: float = 12.0
    """Depth of the seat by the drawing."""
    stands_mm: float | None = None
    """Where the peg meets something; None for the seat."""
    seat_n: float = 15.0
    play_mm: float = 0.1
    """Play between the walls, across."""
    walls: tuple[str, ...] = ("+x", "-x", "+y", "-y")
    """Sides at which there is one."""
    pushed: tuple[str, ...] = ("+x", "-x", "+y", "-y")
    push_n: float = 6.2
    comes_back: bool = False
    """After each push the peg is drawn back to the middle."""
    turn_n_m: tuple[float, ...] = ()
    """Moments that turns about the axis have met."""
    pull_n: float | None = None
    interval_s: float = 0.01
    noise_n: float = 0.02
    lift_by_mm: float = 0.0
    """A push to the side lifts the peg by this."""


@dataclass(slots=True)
class _Recorder:
    made: Inserted
    rows: list[list[float]] = field(default_factory=list)
    kinds: list[tuple[int, str]] = field(default_factory=list)
    tip_mm: Array = field(default_factory=lambda: np.zeros(3))
    motion: int = 0

    def go(self, kind: str, tip_mm: Array, force_n: Array, mz_n_m: float = 0.0) -> None:
        """A motion of 1 mm/s to a tip, with the force rising evenly to its end."""
        self.motion += 1
        way = float(np.linalg.norm(tip_mm - self.tip_mm))
        steps = max(10, round(way / 1.0 / self.made.interval_s))
        begin_n = np.array(self.rows[-1][3:6]) if self.rows else np.zeros(3)
        for step in range(1, steps + 1):
            share = step / steps
            tip = self.tip_mm + share * (tip_mm - self.tip_mm)
            self._add(kind, tip, begin_n + share * (force_n - begin_n), share * mz_n_m)
        self.tip_mm = tip_mm

    def _add(self, kind: str, tip_mm: Array, force_n: Array, mz_n_m: float) -> None:
        self.rows.append([*tip_mm.tolist(), *force_n.tolist(), 0.0, 0.0, mz_n_m])
        self.kinds.append((self.motion, kind))


def inserted(made: Inserted, seed: int = 1) -> tuple[Array, list[tuple[int, str]]]:
    """Rows in the columns of ``NAMES``, shape (n, 10), and the motion of each."""
    k = made.stiffness_n_mm
    stands_mm = made.hole_mm if made.stands_mm is None else made.stands_mm
    recorder = _Recorder(made)
    slide = np.array([0.0, 0.0, -1.0])
    recorder.go("feed", np.array([0.0, 0.0, stands_mm]), slide)
    feeding = recorder.motion
    seat = np.array([0.0, 0.0, stands_mm + made.seat_n / k])
    recorder.go("feed", seat, np.array([0.0, 0.0, -made.seat_n]))
    # One motion, whose force rises at its end.
    recorder.kinds = [(feeding, kind) for _, kind in recorder.kinds]
    pressed = np.array([0.0, 0.0, -_PRESS_N])
    resting = np.array([0.0, 0.0, stands_mm + _PRESS_N / k])
    recorder.go("press", resting, pressed)
    for side in made.pushed:
        _push(recorder, side, resting, pressed)
    for moment in made.turn_n_m:
        recorder.go("turn", recorder.tip_mm, pressed, moment)
        recorder.go("turn", recorder.tip_mm, pressed, 0.0)
    if made.pull_n is not None:
        up = recorder.tip_mm - np.array([0.0, 0.0, made.pull_n / k + _PRESS_N / k])
        recorder.go("touch", up, np.array([0.0, 0.0, made.pull_n]))
    return _noisy(recorder, seed), recorder.kinds


def _push(recorder: _Recorder, side: str, resting: Array, pressed: Array) -> None:
    made = recorder.made
    axis, sign = "xy".index(side[1]), 1.0 if side[0] == "+" else -1.0
    across = np.zeros(3)
    across[axis] = sign
    target = recorder.tip_mm.copy()
    begun, before = len(recorder.kinds), recorder.motion + 1
    if side in made.walls:
        # The force of the other wall goes, then there is none, then that of this wall grows.
        for wall in (-sign, sign):
            between = recorder.tip_mm.copy()
            between[axis], between[2] = wall * made.play_mm / 2, resting[2]
            if sign * (between[axis] - recorder.tip_mm[axis]) > 0.0:
                recorder.go("touch", between, pressed)
        target[axis] = sign * (made.play_mm / 2 + made.push_n / made.stiffness_n_mm)
        force_n = -made.push_n * 1.02 * across
    else:
        target[axis] += sign * (2 * made.play_mm + 0.5)
        force_n = -_FRICTION_N * across
    target[2] = resting[2] - made.lift_by_mm
    recorder.go("touch", target, pressed + force_n)
    recorder.kinds[begun:] = [(before, "touch")] * (len(recorder.kinds) - begun)
    if made.comes_back:
        # Its force falls to nothing where it leaves the wall.
        target[axis] = sign * made.play_mm / 2
        recorder.go("comply", target.copy(), pressed)
        target[axis] = 0.0
        recorder.go("comply", target.copy(), pressed)


def _noisy(recorder: _Recorder, seed: int) -> Array:
    rows = np.array(recorder.rows)
    rows[:, 3:6] += np.random.default_rng(seed).normal(0.0, recorder.made.noise_n, (len(rows), 3))
    times = np.arange(len(rows)) * recorder.made.interval_s
    return np.column_stack([times, rows])


def as_csv(
    rows: Array,
    kinds: Sequence[tuple[int, str]] | None = None,
    names: Sequence[str] = NAMES,
) -> bytes:
    """The file of a curve; without ``kinds`` nobody says which motion a sample belongs to."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([*names, *(("motion", "kind") if kinds else ())])
    for number, row in enumerate(rows):
        named = kinds[number] if kinds else ()
        writer.writerow([*(f"{value:.7g}" for value in row), *named])
    return out.getvalue().encode()
