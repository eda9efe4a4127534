"""Which model of a rim the pixels ask for: the simplest one that they do not contradict.

A model with too few surfaces is wrong by more than it says; one with too many is uncertain without
need. Score tests tell cheaply what a further surface would explain before it is fitted.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import expit

from cellctl.geometry.pose import Array
from cellctl.vision.features.hole_kind import SecondEdge
from cellctl.vision.rim.arcs import rest_waves
from cellctl.vision.rim.covariance import (
    CHANCE,
    MOST_LEFT_OUT,
    misfit_beyond_model,
    with_covariance,
)
from cellctl.vision.rim.fit_input import RimFitInput
from cellctl.vision.rim.light import LightModel
from cellctl.vision.rim.problem import add_to_diagonal, by_radius, with_unit_diagonal
from cellctl.vision.rim.shape import RimShape, outside_circles, outside_walls
from cellctl.vision.rim.solver import (
    RimFit,
    coarse_fit,
    full_fit,
    refine,
    single_image_problem,
    two_image_problem,
)

SIGNIFICANT_GAIN = 15.0
"""Fall of chi square by up to six terms that two rims in a hundred show by chance."""
_RIDGE = 1e-6
"""Keeps terms that the fit already models from counting as evidence."""
_RING_WIDTHS_PX = (1.0, 2.0, 3.5)
"""Widths of a ring that is tested for."""

_START_BLUR_PX = 1.0
_WALL_DEPTHS_M = (1e-3, 2e-3, 4e-3, 9e-3)
"""Depths at which a fit may start: it converges from above the true one, not always from below."""
_HINT_GAIN = 4.0
"""Fall of chi square from which on a fit with a wall is worth its time."""
_WORSE = 0.4
"""Rise of the information criterion for each pixel, residuals half as large again in their squares,
beyond which a smooth light inside is no better explanation than a wall."""
_RING_SLOPES = (0.0, 1.0)
"""A flat ring, and a cone of 90°."""
_BLUR_SIGMA_PX, _KNOWN_BLUR_SIGMA_PX = 0.25, 0.03
"""Prior of the blur about the first guess, and about what other rims of the image have shown."""
_WALL_M, _WALL_SIGMAS = 2e-3, 4.0
"""Depth of a wall that may be all that there is, and its standard deviation over it."""
_UNEVEN_GREY = 15.0
"""Expected unevenness of the turns of a thread, or of what is seen through a bore: standard
deviation of each term."""
_NO_SPREAD: Array = np.zeros((2, 2))
_LEAST_LEFT_OUT = 0.07
"""Share of a rim from which on what has left its fit is no chance: three arcs."""
_DISTURBED = 5.0
"""Misfit from which on something else than texture or a burr must be at a rim: these reach 4.5."""
_PIXELS_ALIKE = 10.0
"""Number of neighbouring pixels whose model errors are alike: evidence is divided by it."""


class ScoreTests:
    """Score tests (Rao) on one fit of one image.

    They tell how far chi square would fall if more were modelled, with shape and light free to
    follow to first order. Nothing has to be fitted for them.
    """

    def __init__(self, fit: RimFit) -> None:
        self._solution, self._shape = fit.solution, fit.shapes[0]
        self._pixels, self._unit_px = fit.problem.views[0].pixels, fit.problem.unit_px
        self._covariance = fit.solution.covariance
        x, y = (self._pixels.points - self._shape.centre[:, None]) / self._shape.radius
        self._radius = np.maximum(np.sqrt(x * x + y * y), 1e-6)
        self._cos, self._sin = x / self._radius, y / self._radius

    def likely_wall(self, ratios: Sequence[float]) -> tuple[float, float]:
        """The wall ratio that would explain most of the misfit of a fit without a wall, and its
        gain, as if a wall of unknown, even grey were seen."""
        seen = outside_walls(self._pixels, self._shape, ratios) - self._solution.outside
        gains = self._gain_of_each(seen)
        best = int(np.argmax(gains))
        return ratios[best], float(gains[best])

    def uneven_inside(self) -> bool:
        """Whether the inside of the rim is not even."""
        below, cos, sin = 1.0 - self._radius, self._cos, self._sin
        rows = np.stack([cos, sin, below, below * cos, below * sin, below * below])
        return self._gain((1.0 - self._solution.outside) * rows) > SIGNIFICANT_GAIN

    def ring_gain(self) -> float:
        """Largest fall of chi square that a narrow ring of another grey would bring."""
        around = np.stack([np.ones_like(self._cos), self._cos, self._sin])
        radii = self._shape.radius + np.array(_RING_WIDTHS_PX) * self._unit_px
        beyond = outside_circles(self._pixels, self._shape, radii)
        return max(self._gain(around * ring) for ring in self._solution.outside - beyond)

    def _gain(self, rows: Array) -> float:
        """Fall of chi square if ``rows`` (k, n) were added to the model with free weights."""
        normal, imitated, score = self._solution.further(rows)
        size, scale = with_unit_diagonal(normal)
        size -= imitated / (scale[:, None] * scale)
        add_to_diagonal(size, _RIDGE)
        score /= scale
        return float(score @ np.linalg.solve(size, score))

    def _gain_of_each(self, rows: Array) -> Array:
        """Fall of chi square for each of ``rows`` (k, n) alone, shape (k,)."""
        solution = self._solution
        weighted = solution.noise.weigh(rows)
        shared = weighted @ solution.design.T
        size = (weighted * rows).sum(axis=1) - ((shared @ self._covariance) * shared).sum(axis=1)
        squares = (weighted @ solution.residuals) ** 2
        return np.where(size > 1e-6, squares / np.maximum(size, 1e-6), 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class SelectedFit:
    """The likeliest of several models of one rim."""

    fit: RimFit
    spread: Array
    """Covariance by the models that are nearly as likely, plane units squared: of (x, y) in one
    image, shape (2, 2), or of (x, y) in both images and the radius, shape (5, 5)."""


def fit_single_image(given: RimFitInput) -> SelectedFit:
    """Fit a rim in one image by itself, with a wall below it or without.

    Where no model explains the rim all round, all are tried again without the arcs that are off the
    circle.
    """
    models = _models_of_a_circle(given)
    chosen = _likelier(models[0], models[-1])
    if misfit_beyond_model(chosen.fit) < _DISTURBED:
        return chosen
    return _rest_or_whole(_of_rest([_without_arcs(given, model) for model in models]), chosen)


def _of_rest(models: list[RimFit]) -> SelectedFit:
    """The likeliest of models each without the arcs that are off its circle; the first has no wall.

    A wall that is hardly seen has terms enough to follow a dent, and takes the rim with it: beside
    dents only what is wider than the blur of its edge counts as one.
    """
    first, *others = (model for model in models if model.crescent_px >= model.shapes[0].blur_px)
    rest = SelectedFit(first, _NO_SPREAD)
    for other in others:
        rest = _likelier(rest.fit, other)
    return rest


def _rest_or_whole(rest: SelectedFit, whole: SelectedFit) -> SelectedFit:
    """The fit without arcs, if it is no chance that they have left and it is disturbed no more.

    Where those that stay are no circle, the centre is as doubtful as the two fits are from each
    other, in any direction.
    """
    problem, solution = rest.fit.problem, rest.fit.solution
    told = _LEAST_LEFT_OUT < solution.noise.share_left_out < MOST_LEFT_OUT
    if not told or misfit_beyond_model(rest.fit) > _DISTURBED:
        return whole
    azimuths, slopes = problem.azimuths(solution.vector), by_radius(problem, solution)
    if not rest_waves(solution.noise, solution.residuals, slopes, azimuths):
        return rest
    centres = 2 * len(problem.views)
    off = solution.vector[:centres] - whole.fit.solution.vector[:centres]
    doubt = np.zeros(len(rest.spread))
    doubt[:centres] = np.repeat((off.reshape(-1, 2) ** 2).sum(axis=1), 2)
    return SelectedFit(rest.fit, rest.spread + np.diag(doubt))


def _without_arcs(given: RimFitInput, model: RimFit) -> RimFit:
    """The fit of a model from where the edges are, without the arcs that are off the circle."""
    start = np.array([*given.centre, given.radius, *model.solution.vector[3:]])
    return full_fit(replace(model.problem, arcs_may_leave=True), start)


def _models_of_a_circle(given: RimFitInput) -> list[RimFit]:
    """Fits with more and more light inside, as far as the pixels ask for it."""
    kind, across_lay = given.roi.kind, given.across_lay()
    light, radius = LightModel(cone=kind.cone), given.roi.nominal_radius
    bare = RimShape(given.centre, given.radius, _START_BLUR_PX)
    problem = single_image_problem(given.pixels, bare, light, radius, across_lay)
    plain = full_fit(problem, bare.vector)
    if not kind.may_show_wall:
        return [plain]
    # The test needs one linear solve, a further fit many. A rim that it passes is done.
    tests = ScoreTests(plain)
    ratio, gain = tests.likely_wall([depth_m / given.roi.distance_m for depth_m in _WALL_DEPTHS_M])
    uneven = tests.uneven_inside()
    if gain < _HINT_GAIN and not uneven:
        return [plain]
    shape = replace(plain.shapes[0], wall_ratio=ratio)
    with_wall = single_image_problem(given.pixels, shape, light, radius, across_lay)
    walled = full_fit(with_wall, shape.vector)
    better = _of_uneven_inside(plain, walled) if uneven else walled
    return [plain, walled] if better is walled else [plain, walled, better]


def _of_uneven_inside(plain: RimFit, walled: RimFit) -> RimFit:
    """The better fit of a rim whose inside is not even: with a wall, or with any smooth light.

    Through a bore another part may be seen, whose edges lie anywhere inside the rim. No wall looks
    like that, and one that is fitted nonetheless takes the rim with it.
    """
    anything = replace(plain.problem.light, uneven_grey=_UNEVEN_GREY)
    smooth = full_fit(replace(plain.problem, light=anything), plain.solution.vector)
    behind = smooth.bic(held=True) - walled.bic(held=True)
    allowed = 0.0
    if _pulled(walled) and not _pulled(smooth):
        allowed = _WORSE * len(smooth.solution.residuals)
    return smooth if behind < allowed else walled


def _pulled(fit: RimFit) -> bool:
    """Whether the residuals pull at the centre by more than chance."""
    return with_covariance(fit, _NO_SPREAD).misfit > CHANCE


def _likelier(plain: RimFit, other: RimFit) -> SelectedFit:
    """The better one by the information criterion; the other widens its covariance."""
    for_other = float(expit(0.5 * (plain.bic() - other.bic())))
    # The probability of the rejected model times the squared distance of its centre is the variance
    # that choosing between them adds.
    off = other.solution.vector[:2] - plain.solution.vector[:2]
    best, against = (other, 1.0 - for_other) if for_other > 0.5 else (plain, for_other)
    return SelectedFit(best, np.outer(off, off) * against)


def fit_two_edges(
    given: tuple[RimFitInput, RimFitInput],
    second: SecondEdge,
    blur_px: tuple[float, float] | None,
    wall_ratio: float | None = None,
) -> SelectedFit:
    """Fit a rim in both images at once: with a flat ring, with a cone, or with a wall alone.

    ``blur_px`` is the blur that other rims have shown in these images, where there are any, and
    ``wall_ratio`` the depth of a wall that fits of each image by itself have found. The
    outer edge of a cone lies nearer to the cameras than the rim, so the two images show it in
    different places: that tells a cone from a flat ring.
    """
    blurs, blur_sigma = (_START_BLUR_PX, _START_BLUR_PX), _BLUR_SIGMA_PX
    if blur_px is not None:
        blurs, blur_sigma = blur_px, _KNOWN_BLUR_SIGMA_PX
    pixels, across_lay = (given[0].pixels, given[1].pixels), given[0].across_lay()

    def coarse(sigma: float, *, arcs: bool, **second_edge: float) -> RimFit:
        left, right = (
            RimShape(one.centre, one.roi.nominal_radius, blur, **second_edge)
            for one, blur in zip(given, blurs, strict=True)
        )
        light = LightModel(uneven_grey=_UNEVEN_GREY)
        problem = two_image_problem(pixels, (left, right), light, (blur_sigma, sigma), across_lay)
        return coarse_fit(replace(problem, arcs_may_leave=arcs), problem.mean)

    def likeliest(*, arcs: bool) -> SelectedFit:
        models = [
            coarse(second.sigma, arcs=arcs, ring_ratio=ring, ring_slope=slope)
            for slope in _RING_SLOPES
        ]
        if not given[0].roi.kind.turns:
            # In an image out of focus a bore with a wall looks as if it had a ring.
            models.append(coarse(_WALL_SIGMAS * wall, arcs=arcs, wall_ratio=wall))
        return _likeliest(models)

    # A fit does not always come up to a wall from far below its depth.
    ring, wall = 1.0 + second.width, wall_ratio or _WALL_M / given[0].roi.distance_m
    # Coarse fits are enough to compare the models; only the likeliest one is brought to its end.
    chosen = likeliest(arcs=False)
    if misfit_beyond_model(chosen.fit) < _DISTURBED:
        return chosen
    return _rest_or_whole(likeliest(arcs=True), chosen)


def _likeliest(models: list[RimFit]) -> SelectedFit:
    """The best of the models; by how much the others differ, weighted by how likely they are."""
    # One noise for all: each model's own would excuse the very residuals that speak against it.
    noise = models[0].solution.noise
    costs = np.array([model.solution.cost_under(noise) for model in models])
    best = int(np.argmin(costs))
    likelihoods = np.exp(-0.5 * (costs - costs[best]) / _PIXELS_ALIKE)
    geometry = np.array([model.solution.vector[:5] for model in models])
    off = geometry - geometry[best]
    spread = (off * (likelihoods / likelihoods.sum())[:, None]).T @ off
    return SelectedFit(refine(models[best]), np.asarray(spread))
