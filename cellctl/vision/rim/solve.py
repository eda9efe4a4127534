"""Robust least squares for the shape of a rim, by damped Gauss-Newton steps."""

from dataclasses import replace

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.rim.matrix import add_to_diagonal, with_unit_diagonal
from cellctl.vision.rim.problem import Problem, Solution, refreshed, solved

_MAX_ROUNDS, _MAX_STEPS = 12, 8
_ROUGH_PX, _SETTLED_PX = 0.15, 0.01
"""Steps at which a round ends: before the noise is known, and after."""
_LOWER_EDGE = 0.03
"""How much of a movement of the lower edge reaches the rim, at most."""
_EXTRAPOLATE_PX = 0.01
_MAX_STEP_PX = 0.7
_MAX_DAMPING = 1e4


def minimise(
    problem: Problem, start: Solution, *, tolerance_px: float = 1.5e-3, weighing_rounds: int = 2
) -> tuple[Solution, bool]:
    """The best solution, and whether it settled.

    The terms of the light depend weakly on the shape. They are held fixed for a few steps and then
    brought up to date; the series of these rounds converges linearly and is extrapolated. The
    noise of the pixels is final after ``weighing_rounds``.
    """
    best = start
    before: Array | None = None
    change_px = np.inf
    for number in range(_MAX_ROUNDS):
        anchor = best.vector
        best = _settle(problem, best, _SETTLED_PX if number else _ROUGH_PX)
        change = best.vector - anchor
        change_px = _step_px(problem, change)
        weighing = number < weighing_rounds
        if change_px < tolerance_px and not weighing:
            return best, True
        if before is not None and change_px < _EXTRAPOLATE_PX:
            best = replace(best, vector=best.vector + change * _gain(problem, before, change))
        before = None if weighing else change
        best = refreshed(problem, best, weigh=weighing)
    return best, change_px < 4.0 * tolerance_px


def _settle(problem: Problem, best: Solution, settled_px: float) -> Solution:
    """Damped Gauss-Newton steps with the terms of the light held fixed."""
    damping = 1e-6
    for _ in range(_MAX_STEPS):
        trial = solved(problem, _moved(problem, best, damping), best.noise, best.parts)
        if trial.cost > best.cost * (1.0 + 1e-9) and damping < _MAX_DAMPING:
            damping = max(damping, 1e-4) * 10.0
            continue
        change = trial.vector - best.vector
        step_px = _step_px(problem, change)
        best, damping = trial, damping * 0.2
        if max(step_px, _LOWER_EDGE * _lower_edge_px(problem, change)) < settled_px:
            break
    return best


def _gain(problem: Problem, before: Array, change: Array) -> float:
    """Sum of the rest of a geometric series from its last two terms."""
    views = problem.views
    last = np.concatenate([(view.selection @ change)[:3] / view.pixels.unit_px for view in views])
    first = np.concatenate([(view.selection @ before)[:3] / view.pixels.unit_px for view in views])
    ratio = float(np.clip(last @ first / max(float(first @ first), 1e-12), 0.0, 0.8))
    return ratio / (1.0 - ratio)


def _moved(problem: Problem, solution: Solution, damping: float) -> Array:
    """Joint parameters after a damped Gauss-Newton step."""
    scaled, size = with_unit_diagonal(solution.normal)
    add_to_diagonal(scaled, damping + 1e-10)
    gradient = solution.design @ solution.noise.weigh(solution.residuals)
    gradient += solution.precision * solution.pull
    step = (np.linalg.solve(scaled, gradient / size) / size)[solution.lights :]
    longest = _step_px(problem, step)
    return np.asarray(solution.vector + step * min(1.0, _MAX_STEP_PX / max(longest, 1e-12)))


def _step_px(problem: Problem, step: Array) -> float:
    """Largest movement of a centre or change of a radius in any view."""
    return max(
        float(np.abs((view.selection @ step)[:3]).max()) / view.pixels.unit_px
        for view in problem.views
    )


def _lower_edge_px(problem: Problem, step: Array) -> float:
    """Movement of the lower edge of a wall against the rim."""
    moved = 0.0
    for view in problem.views:
        if view.model.wall_ratio is not None:
            change = abs(float((view.selection @ step)[4]))
            foot_px = float(np.linalg.norm(view.pixels.points[:, 0])) / view.pixels.unit_px
            moved = max(moved, change * foot_px)
    return moved
