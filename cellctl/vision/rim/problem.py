"""A rim in one or more images as a least-squares problem, and the best light for a given shape.

Light enters linearly and is eliminated for each trial shape. Priors on shape and light are part of
the cost.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.rim.lay import strokes
from cellctl.vision.rim.light import Light, Surface, surfaces
from cellctl.vision.rim.matrix import add_to_diagonal, with_unit_diagonal
from cellctl.vision.rim.model import Border, RimPixels, RimShape, borders
from cellctl.vision.rim.noise import Noise, noise_of

_BLUR_LIMITS_PX = (0.35, 4.0)
_WALL_LIMITS = (0.0, 0.2)
_RING_LIMITS = (1.02, 1.7)
_RIDGE = 1e-11
"""Of a normal matrix with a unit diagonal: terms that no pixel shows stay finite."""
_FLAT_WEIGHT = 0.04
"""Of every pixel before its noise is known, 1/grey²."""


def _inside(value: float, limits: tuple[float, float]) -> float:
    return min(max(value, limits[0]), limits[1])


@dataclass(frozen=True, slots=True)
class RimView:
    """One image of the rim."""

    pixels: RimPixels
    model: RimShape
    """Which parts are modelled; its numbers do not matter."""
    selection: Array
    """Shape (len(model.vector), m): the view's shape from the m joint parameters."""
    gain: float = 1.0
    """Brightness of this image relative to the others."""

    def shape(self, vector: Array) -> RimShape:
        """The shape of the rim in this image, inside what is physically possible."""
        values = self.selection @ vector
        values[3] = _inside(values[3], _BLUR_LIMITS_PX)
        if self.model.wall_ratio is not None:
            values[4] = _inside(values[4], _WALL_LIMITS)
        if self.model.ring_ratio is not None:
            values[-1] = _inside(values[-1], _RING_LIMITS)
        return self.model.with_vector(values)


@dataclass(frozen=True, slots=True)
class Problem:
    """All images of one rim, and what is known beforehand."""

    views: tuple[RimView, ...]
    light: Light
    mean: Array
    """Prior of the joint parameters, shape (m,)."""
    sigma: Array
    """Infinite where nothing is known."""
    across_lay: Array | None = None
    """Unit vector in the plane across the lay of the face, if it has one."""
    ring_level_grey: float = 3.0
    """How much the ring's mean grey may differ between cameras, standard deviation."""
    ring_variation_grey: float = 0.6
    """The same for each term of its variation with the azimuth: one lamp lights it for both."""

    @property
    def unit_px(self) -> float:
        """Plane units in a pixel of the first view."""
        return self.views[0].pixels.unit_px


@dataclass(frozen=True)
class Solution:
    """Best light for one vector of joint parameters, and what the next step needs."""

    vector: Array
    parts: tuple[Sequence[Surface], ...]
    """Surfaces of each view."""
    noise: Noise
    residuals: Array
    design: Array
    """Rows: light, then joint parameters, shape (lights + m, n)."""
    precision: Array
    """Of the priors, shape (lights + m,)."""
    pull: Array
    """Prior mean minus present value, shape (lights + m,)."""
    outside: Array
    """Share of each pixel outside the rim."""
    face: Array
    """Share of each pixel that the face covers, outside the ring, if there is one."""

    @property
    def lights(self) -> int:
        """Number of light terms."""
        return len(self.design) - len(self.vector)

    def unevenness_grey(self, sigma_grey: float) -> float:
        """Root mean square of the terms of the light whose prior has this standard deviation."""
        ours = np.isclose(self.precision[: self.lights], sigma_grey**-2.0)
        return float(np.sqrt(np.mean(self.pull[: self.lights][ours] ** 2)))

    @cached_property
    def cost(self) -> float:
        """Weighted squares of residuals and priors."""
        return self.cost_under(self.noise)

    def cost_under(self, noise: Noise) -> float:
        """The same under another noise, to compare models of the same pixels."""
        squares = self.residuals @ noise.weigh(self.residuals)
        return float(squares + self.precision @ self.pull**2)

    @cached_property
    def normal(self) -> Array:
        """Normal matrix over light and joint parameters."""
        normal = self.noise.weigh(self.design) @ self.design.T
        add_to_diagonal(normal, self.precision)
        return np.asarray(normal)

    @cached_property
    def covariance(self) -> Array:
        """Covariance of light and joint parameters for independent pixels."""
        scaled, size = with_unit_diagonal(self.normal)
        add_to_diagonal(scaled, _RIDGE)
        return np.asarray(np.linalg.inv(scaled) / (size[:, None] * size))


def first(problem: Problem, vector: Array) -> Solution:
    """Solution at the start: equal weights."""
    count = sum(len(view.pixels.grey) for view in problem.views)
    noise = Noise.of(np.full(count, _FLAT_WEIGHT), np.empty((0, count)))
    return solved(problem, vector, noise)


def refreshed(problem: Problem, solution: Solution, *, weigh: bool = True) -> Solution:
    """The same shape with the terms of the light brought up to date, and the noise on request."""
    noise = solution.noise
    if weigh:
        noise = noise_of(solution.residuals, solution.outside, _strokes(problem, solution))
    return solved(problem, solution.vector, noise)


def _strokes(problem: Problem, solution: Solution) -> Array:
    """Strokes of unit height, shape (k, n): all views see the same ones."""
    if problem.across_lay is None:
        return np.empty((0, len(solution.residuals)))
    offsets, gains = [], []
    for view in problem.views:
        centre = view.shape(solution.vector).centre
        offsets.append((view.pixels.points - centre[:, None]) / problem.unit_px)
        gains.append(np.full(len(view.pixels.grey), view.gain))
    radius_px = problem.views[0].shape(solution.vector).radius / problem.unit_px
    pattern = strokes(np.concatenate(offsets, axis=1), problem.across_lay, radius_px)
    return np.asarray(pattern * (solution.face * np.concatenate(gains)))


def solved(
    problem: Problem,
    vector: Array,
    noise: Noise,
    parts: tuple[Sequence[Surface], ...] | None = None,
) -> Solution:
    """Best light by linear least squares, and the derivatives of all pixels.

    A pixel is the sum of its surfaces' greys times the shares that they cover. The terms of the
    light are those of ``parts``, or of the shape as it stands.
    """
    shapes = [view.shape(vector) for view in problem.views]
    edges = [borders(view.pixels, shape) for view, shape in zip(problem.views, shapes, strict=True)]
    if parts is None:
        parts = tuple(
            surfaces(view.pixels, shape, edge, problem.light)
            for view, shape, edge in zip(problem.views, shapes, edges, strict=True)
        )
    layout = _Layout.of(problem, parts)
    terms = np.zeros((layout.lights, len(noise.weights)))
    for rows, columns, gain, part, edge in layout.blocks(problem, parts, edges):
        terms[rows, columns] = part.terms * (gain * part.share(edge))
    grey = np.concatenate([view.pixels.grey for view in problem.views])
    weighted = noise.weigh(terms)
    gram = weighted @ terms.T
    add_to_diagonal(gram, layout.precision + 1e-9 * float(gram.diagonal().max()))
    levels = np.linalg.solve(gram, weighted @ grey)
    by_vector = np.zeros((len(vector), len(noise.weights)))
    for rows, columns, gain, part, edge in layout.blocks(problem, parts, edges):
        view = problem.views[layout.view_of(columns)]
        by_vector[:, columns] += view.selection.T @ part.by_shape(edge, gain * levels[rows])
    rims = [0 if view.model.ring_ratio is None else 1 for view in problem.views]
    return Solution(
        vector,
        parts,
        noise,
        grey - levels @ terms,
        np.concatenate([terms, by_vector]),
        np.concatenate([layout.precision, problem.sigma**-2.0]),
        np.concatenate([-levels, problem.mean - vector]),
        np.concatenate([edge[rim].outside for edge, rim in zip(edges, rims, strict=True)]),
        np.concatenate([edge[0].outside for edge in edges]),
    )


@dataclass(frozen=True, slots=True)
class _Layout:
    """Where each surface's terms lie in the design: rings share their rows between views."""

    lights: int
    precision: Array
    rows: tuple[tuple[tuple[int, int, slice], ...], ...]
    """For each view: (part index, which copy, rows)."""
    columns: tuple[slice, ...]

    @classmethod
    def of(cls, problem: Problem, parts: tuple[Sequence[Surface], ...]) -> "_Layout":
        used, precision, ring = 0, [], None
        rows, columns, pixel = [], [], 0
        for view, surfaces_of_view in zip(problem.views, parts, strict=True):
            mine = []
            for index, part in enumerate(surfaces_of_view):
                count = len(part.terms)
                sigma = part.sigma_grey
                if part.ring and ring is not None:
                    mine.append((index, 0, ring))
                    sigma = np.full(count, problem.ring_variation_grey)
                    sigma[0] = problem.ring_level_grey
                block = slice(used, used + count)
                if part.ring and ring is None:
                    ring = block
                mine.append((index, 1, block))
                used += count
                precision.append(sigma**-2.0)
            rows.append(tuple(mine))
            columns.append(slice(pixel, pixel + len(view.pixels.grey)))
            pixel += len(view.pixels.grey)
        return cls(used, np.concatenate(precision), tuple(rows), tuple(columns))

    def blocks(
        self,
        problem: Problem,
        parts: tuple[Sequence[Surface], ...],
        edges: Sequence[Sequence[Border]],
    ) -> list[tuple[slice, slice, float, Surface, Sequence[Border]]]:
        """Rows, columns, gain, surface and borders of every block of the design."""
        return [
            (
                rows,
                self.columns[which],
                problem.views[which].gain,
                parts[which][index],
                edges[which],
            )
            for which, mine in enumerate(self.rows)
            for index, _, rows in mine
        ]

    def view_of(self, columns: slice) -> int:
        """Index of the view whose pixels these are."""
        return self.columns.index(columns)
