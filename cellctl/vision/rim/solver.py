"""Robust maximum-likelihood fit of a rim by damped Gauss-Newton steps, in one image or in both."""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.rim.light import LightModel
from cellctl.vision.rim.noise import median
from cellctl.vision.rim.problem import (
    RimProblem,
    RimSolution,
    RimView,
    add_to_diagonal,
    initial_solution,
    relinearised,
    solve_light,
    with_unit_diagonal,
)
from cellctl.vision.rim.shape import RimPixels, RimShape

_RADIUS_SIGMA = 0.005
"""Standard deviation of the radius about the drawing's, relative. It counts only where little of a
rim stands out."""
_WALL_SIGMAS = 4.0
"""Standard deviation of a wall's depth over its first guess. Where the lower edge of the wall is
out of sight, nothing else holds its depth."""
_COARSE_PX, _FINE_PX = 0.03, 1.5e-3
"""Change of the rim in a round below which a fit has settled."""
_WEIGHING, _WEIGHING_ARCS = 2, 4
"""Rounds in which the noise follows the residuals. A dent that has pulled at the rim until then is
told from the rest of it only in the course of a few."""
_MAX_ROUNDS, _MAX_STEPS = 30, 8
"""Most fits settle in four rounds; one in a hundred creeps for more than twelve. A rim that is
given up for that costs the whole run."""
_ROUGH_PX, _SETTLED_PX = 0.15, 0.01
"""Steps at which a round ends: before the noise is known, and after."""
_LOWER_EDGE = 0.03
"""Largest share of a movement of the wall's lower edge by which the rim follows it. A round that
ended without regard to that edge left its way to the next ones: one fit in five then took seven to
thirty rounds instead of one in twenty (24 pairs of images of three assemblies)."""
_MAX_STEP_PX = 0.7
"""Longest step of a centre or a radius; see ``_moved``."""
_MAX_DAMPING = 1e4
"""Beyond it a step is taken although it makes the cost greater: what is left of that is
rounding."""


@dataclass(frozen=True, slots=True)
class RimFit:
    """A model of a rim at its best, before anything is said about its uncertainty."""

    problem: RimProblem
    solution: RimSolution
    converged: bool

    @property
    def shapes(self) -> tuple[RimShape, ...]:
        """The geometry of the rim in each image."""
        return tuple(view.shape(self.solution.vector) for view in self.problem.views)

    @property
    def crescent_px(self) -> float:
        """Width of the visible wall where it is widest, of one image; infinite without a wall."""
        shape = self.shapes[0]
        if shape.wall_ratio is None:
            return float(np.inf)
        farthest_px = (np.linalg.norm(shape.centre) + shape.radius) / self.problem.unit_px
        return float(farthest_px * shape.wall_ratio / (1.0 + shape.wall_ratio))

    def bic(self, *, held: bool = False) -> float:
        """Bayesian information criterion, to compare models on the same pixels.

        An unknown that a prior holds is not free to follow the noise. With ``held`` it counts by
        the share of it that the pixels determine, for models that hold very many.
        """
        noise, residuals = self.solution.noise, self.solution.residuals
        if self.problem.arcs_may_leave:
            residuals = noise.own(residuals)
        residuals = np.abs(residuals)
        count = len(residuals)
        # Clipped like the weights of the fit: otherwise one scratch would decide between two
        # models.
        limit = 4.0 * max(median(residuals), 0.2)
        # An arc that has left the fit is not explained, however the model looks there.
        unexplained = np.where(noise.left_out, limit, np.minimum(residuals, limit))
        mean_square = float(np.mean(unexplained**2))
        prior = self.solution.precision
        free = float(np.count_nonzero(prior == 0.0))
        if held:
            shares = 1.0 - prior * self.solution.covariance.diagonal()
            free += float(np.maximum(shares[prior > 0.0], 0.0).sum())
        return count * float(np.log(mean_square)) + free * float(np.log(count))


def single_image_problem(
    pixels: RimPixels, start: RimShape, light: LightModel, radius: float, across_lay: Array | None
) -> RimProblem:
    """One image of a rim of about ``radius`` (plane units), with the parts that ``start`` has.

    ``across_lay`` is the unit vector across the lay of the face, if it has one.
    """
    mean, sigma = start.vector, np.full(len(start.vector), np.inf)
    # The prior is the size on the drawing, not the located size: the edges that located the rim are
    # the same pixels, and would be counted twice.
    mean[2], sigma[2] = radius, _RADIUS_SIGMA * radius
    if start.wall_ratio is not None:
        sigma[4] = _WALL_SIGMAS * start.wall_ratio
    view = RimView(pixels, start, np.eye(len(mean)))
    return RimProblem((view,), light, mean, sigma, across_lay)


def two_image_problem(
    pixels: tuple[RimPixels, RimPixels],
    starts: tuple[RimShape, RimShape],
    light: LightModel,
    sigmas: tuple[float, float],
    across_lay: Array | None,
) -> RimProblem:
    """Both images of a rim with a ring round it or a wall below; ``starts`` are the prior means.

    A ring two pixels wide whose grey is not known is easily taken for a shift of the rim. Both
    cameras see the same ring in the same light: what they share is estimated once, so that the
    difference between the images, hence the depth, does not suffer from it.

    ``sigmas`` are the standard deviations of the blur in px and of the ring or wall ratio. Joint
    parameters: x, y left; x, y right; radius left; blur left and right; ratio.
    """
    left, right = starts
    # Plane units are distances from the camera: the camera that is nearer sees a larger radius.
    nearer, ratio = right.radius / left.radius, float(left.vector[4])
    selections = np.zeros((2, 5, 8))
    selections[0, range(5), [0, 1, 4, 5, 7]] = 1.0
    selections[1, range(5), [2, 3, 4, 6, 7]] = [1.0, 1.0, nearer, 1.0, 1.0]
    if left.wall_ratio is not None:
        selections[1, 4, 7] = nearer
    mean = np.array([*left.centre, *right.centre, left.radius, left.blur_px, right.blur_px, ratio])
    sigma = np.full(len(mean), np.inf)
    sigma[4] = _RADIUS_SIGMA * left.radius
    sigma[5:7], sigma[7] = sigmas
    outer = [float(np.percentile(part.grey, 90)) for part in pixels]
    views = tuple(
        RimView(part, shape, selection, grey / outer[0])
        for part, shape, selection, grey in zip(pixels, starts, selections, outer, strict=True)
    )
    return RimProblem(views, light, mean, sigma, across_lay)


def full_fit(problem: RimProblem, start: Array) -> RimFit:
    """Fit from a vector of joint parameters within 1–2 px of the truth."""
    rounds = _WEIGHING_ARCS if problem.arcs_may_leave else _WEIGHING
    return _minimised(problem, initial_solution(problem, start), _FINE_PX, weighing_rounds=rounds)


def coarse_fit(problem: RimProblem, start: Array) -> RimFit:
    """A quick fit to a few hundredths of a pixel: enough to compare models, then ``refine``."""
    rounds = (_WEIGHING_ARCS if problem.arcs_may_leave else _WEIGHING) - 1
    return _minimised(problem, initial_solution(problem, start), _COARSE_PX, weighing_rounds=rounds)


def refine(coarse: RimFit) -> RimFit:
    """A coarse fit brought to its end; the noise that it has found stays."""
    start = relinearised(coarse.problem, coarse.solution)
    return _minimised(coarse.problem, start, _FINE_PX, weighing_rounds=0)


def _minimised(
    problem: RimProblem, start: RimSolution, tolerance_px: float, *, weighing_rounds: int
) -> RimFit:
    """The best solution, and whether it settled.

    The terms of the light depend weakly on the shape. They are held fixed for a few steps and then
    brought up to date. The noise of the pixels is final after ``weighing_rounds``: weights that
    follow the residuals for ever can make a fit swing between two solutions.
    """
    best = start
    change_px = np.inf
    for number in range(_MAX_ROUNDS):
        anchor = best.vector
        best = _settle(problem, best, _SETTLED_PX if number else _ROUGH_PX)
        change_px = _step_px(problem, best.vector - anchor)
        weighing = number < weighing_rounds
        if change_px < tolerance_px and not weighing:
            return RimFit(problem, best, converged=True)
        best = relinearised(problem, best, weigh=weighing)
    # A fit that creeps has nearly settled: four times the finer tolerance is 0.006 px.
    return RimFit(problem, best, change_px < 4.0 * tolerance_px)


def _settle(problem: RimProblem, best: RimSolution, settled_px: float) -> RimSolution:
    """Damped Gauss-Newton steps (Levenberg-Marquardt) with the terms of the light held fixed."""
    damping = 1e-6
    for _ in range(_MAX_STEPS):
        # A step that makes it worse is not taken. More damping shortens the next and turns it
        # towards the steepest descent (Marquardt).
        trial = solve_light(problem, _moved(problem, best, damping), best.noise, best.parts)
        if trial.cost > best.cost * (1.0 + 1e-9) and damping < _MAX_DAMPING:
            damping = max(damping, 1e-4) * 10.0
            continue
        change = trial.vector - best.vector
        step_px = _step_px(problem, change)
        best, damping = trial, damping * 0.2
        if max(step_px, _LOWER_EDGE * _lower_edge_px(problem, change)) < settled_px:
            break
    return best


def _moved(problem: RimProblem, solution: RimSolution, damping: float) -> Array:
    """Joint parameters after a damped Gauss-Newton step."""
    scaled, size = with_unit_diagonal(solution.normal)
    add_to_diagonal(scaled, damping + 1e-10)
    gradient = solution.design @ solution.noise.weigh(solution.residuals)
    gradient += solution.precision * solution.pull
    step = (np.linalg.solve(scaled, gradient / size) / size)[solution.lights :]
    longest = _step_px(problem, step)
    # An edge blurred over about a pixel is visible only within a pixel or so: a longer step would
    # leave the range in which the derivatives say anything.
    return np.asarray(solution.vector + step * min(1.0, _MAX_STEP_PX / max(longest, 1e-12)))


def _step_px(problem: RimProblem, step: Array) -> float:
    """Largest movement of a centre or change of a radius in any view."""
    return max(
        float(np.abs((view.selection @ step)[:3]).max()) / view.pixels.unit_px
        for view in problem.views
    )


def _lower_edge_px(problem: RimProblem, step: Array) -> float:
    """Movement of the lower edge of a wall against the rim."""
    moved = 0.0
    for view in problem.views:
        if view.model.wall_ratio is not None:
            change = abs(float((view.selection @ step)[4]))
            foot_px = float(np.linalg.norm(view.pixels.points[:, 0])) / view.pixels.unit_px
            moved = max(moved, change * foot_px)
    return moved
