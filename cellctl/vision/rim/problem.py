"""A rim in one or both images as a least-squares problem, and the best light for a given shape.

Grey values depend linearly on the light and nonlinearly on the few numbers of the shape. The light
is therefore solved for exactly at each trial shape (variable projection), and only the shape is
searched. Priors on shape and light are part of the cost.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_array

from cellctl.geometry.pose import Array
from cellctl.vision.rim.arcs import with_arcs
from cellctl.vision.rim.light import LightModel, Surface, surfaces
from cellctl.vision.rim.noise import PixelNoise, no_strokes, noise_of, stroke_pattern
from cellctl.vision.rim.shape import Border, RimPixels, RimShape, borders

_BLUR_LIMITS_PX = (0.35, 4.0)
"""The pixel alone blurs by 0.29 px (a box of one pixel has the variance 1/12)."""
_WALL_LIMITS = (0.0, 0.2)
"""Depth of a wall over the distance of the plane: at 500 mm a bore of at most 100 mm."""
_RING_LIMITS = (1.02, 1.7)
"""Outside of these a ring means something else: one of no width has the rim's own edge."""
_RIDGE = 1e-11
"""Added to the unit diagonal of a normal matrix, so that terms that no pixel shows stay finite."""
_FLAT_WEIGHT = 0.04
"""Weight of every pixel before its noise is known, 1/grey²: that of a noise of 5 grey."""


def add_to_diagonal(matrix: Array, values: Array | float) -> None:
    """Add to the diagonal of a square matrix, in place."""
    matrix.flat[:: len(matrix) + 1] += values


def with_unit_diagonal(normal: Array) -> tuple[Array, Array]:
    """A normal matrix (n, n) for unknowns in units of their own size (n,), and these sizes.

    Grey values, pixels and ratios differ by orders of magnitude: without this the matrix is close
    to singular in floating point.
    """
    size = np.sqrt(normal.diagonal()) + 1e-12
    return normal / (size[:, None] * size), size


def _inside(value: float, limits: tuple[float, float]) -> float:
    return min(max(value, limits[0]), limits[1])


@dataclass(frozen=True, slots=True, eq=False)
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
        # Clipped here and not in the step of the solver: the search may leave these limits and come
        # back, while the model is only ever computed inside them.
        values[3] = _inside(values[3], _BLUR_LIMITS_PX)
        if self.model.wall_ratio is not None:
            values[4] = _inside(values[4], _WALL_LIMITS)
        if self.model.ring_ratio is not None:
            values[-1] = _inside(values[-1], _RING_LIMITS)
        return self.model.with_vector(values)


@dataclass(frozen=True, slots=True, eq=False)
class RimProblem:
    """All images of one rim, and what is known beforehand."""

    views: tuple[RimView, ...]
    light: LightModel
    mean: Array
    """Prior of the joint parameters, shape (m,)."""
    sigma: Array
    """Infinite where nothing is known."""
    across_lay: Array | None = None
    """Unit vector in the plane across the lay of the face, if it has one."""
    arcs_may_leave: bool = False
    """Whether arcs of the rim may be off its circle."""
    ring_level_grey: float = 3.0
    """Standard deviation of the difference of the ring's mean grey between the cameras."""
    ring_variation_grey: float = 0.6
    """The same for each term of the variation with azimuth; it is small, as both see one lamp."""

    @property
    def unit_px(self) -> float:
        """Plane units in a pixel of the first view."""
        return self.views[0].pixels.unit_px

    @property
    def geometry(self) -> int:
        """Number of the first joint parameters: x and y in every view, then the radius."""
        return 2 * len(self.views) + 1

    def azimuths(self, vector: Array) -> Array:
        """Directions of all pixels from the centre, in the plane, rad."""
        x, y = np.concatenate(
            [view.pixels.points - view.shape(vector).centre[:, None] for view in self.views], axis=1
        )
        return np.asarray(np.arctan2(y, x))


@dataclass(frozen=True, eq=False)
class RimSolution:
    """Best light for one vector of joint parameters, and what the next step needs."""

    vector: Array
    parts: tuple[Sequence[Surface], ...]
    """Surfaces of each view."""
    noise: PixelNoise
    residuals: Array
    design: Array
    """Derivatives of all pixels by the light, then by the joint parameters: (lights + m, n)."""
    precision: Array
    """Precisions of the priors, shape (lights + m,)."""
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

    @cached_property
    def cost(self) -> float:
        """Weighted squares of residuals and priors."""
        return self.cost_under(self.noise)

    def cost_under(self, noise: PixelNoise) -> float:
        """The cost under another noise, to compare models of the same pixels."""
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

    def further(self, rows: Array) -> tuple[Array, Array, Array]:
        """What the pixels say of further terms ``rows`` (k, n), with free amplitudes.

        Their normal matrix (k, k), the part of it that the present model can imitate, which is no
        evidence, and their score (k,).
        """
        weighted = self.noise.weigh(rows)
        shared = weighted @ self.design.T
        imitated = shared @ self.covariance @ shared.T
        return weighted @ rows.T, imitated, weighted @ self.residuals


def initial_solution(problem: RimProblem, vector: Array) -> RimSolution:
    """Solution at the start, where the noise is not known yet: equal weights."""
    count = sum(len(view.pixels.grey) for view in problem.views)
    noise = PixelNoise.of(np.full(count, _FLAT_WEIGHT), no_strokes(count))
    return solve_light(problem, vector, noise)


def relinearised(problem: RimProblem, solution: RimSolution, *, weigh: bool = True) -> RimSolution:
    """The same shape with the terms of the light brought up to date, and the noise on request."""
    noise = solution.noise
    if weigh:
        noise = noise_of(solution.residuals, solution.outside, _strokes(problem, solution))
    if weigh and problem.arcs_may_leave:
        azimuths = problem.azimuths(solution.vector)
        noise = with_arcs(noise, solution.residuals, by_radius(problem, solution), azimuths)
    return solve_light(problem, solution.vector, noise)


def by_radius(problem: RimProblem, solution: RimSolution) -> Array:
    """Derivative of the grey values by the radius in px, shape (n,)."""
    return np.asarray(solution.design[solution.lights + problem.geometry - 1] * problem.unit_px)


def _strokes(problem: RimProblem, solution: RimSolution) -> csr_array:
    """Strokes of unit height, shape (k, n): all views see the same ones."""
    if problem.across_lay is None:
        return no_strokes(len(solution.residuals))
    offsets, gains = [], []
    for view in problem.views:
        centre = view.shape(solution.vector).centre
        offsets.append((view.pixels.points - centre[:, None]) / problem.unit_px)
        gains.append(np.full(len(view.pixels.grey), view.gain))
    radius_px = problem.views[0].shape(solution.vector).radius / problem.unit_px
    pattern = stroke_pattern(np.concatenate(offsets, axis=1), problem.across_lay, radius_px)
    return csr_array(pattern * (solution.face * np.concatenate(gains)))


def solve_light(
    problem: RimProblem,
    vector: Array,
    noise: PixelNoise,
    parts: tuple[Sequence[Surface], ...] | None = None,
) -> RimSolution:
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
    blocks, light_precision = _blocks(problem, parts, edges)
    terms = np.zeros((len(light_precision), len(noise.weights)))
    for block in blocks:
        share = block.view.gain * block.surface.share(block.borders)
        terms[block.rows, block.columns] = block.surface.terms * share
    grey = np.concatenate([view.pixels.grey for view in problem.views])
    weighted = noise.weigh(terms)
    # Terms that overlap fully, such as two levels of the light in a band without contrast, leave
    # this matrix singular but for the small ridge.
    gram = weighted @ terms.T
    add_to_diagonal(gram, light_precision + 1e-9 * float(gram.diagonal().max()))
    levels = np.linalg.solve(gram, weighted @ grey)
    by_vector = np.zeros((len(vector), len(noise.weights)))
    for block in blocks:
        amplitudes = block.view.gain * levels[block.rows]
        by_shape = block.surface.by_shape(block.borders, amplitudes)
        by_vector[:, block.columns] += block.view.selection.T @ by_shape
    rims = [0 if view.model.ring_ratio is None else 1 for view in problem.views]
    return RimSolution(
        vector,
        parts,
        noise,
        grey - levels @ terms,
        np.concatenate([terms, by_vector]),
        np.concatenate([light_precision, problem.sigma**-2.0]),
        np.concatenate([-levels, problem.mean - vector]),
        np.concatenate([edge[rim].outside for edge, rim in zip(edges, rims, strict=True)]),
        np.concatenate([edge[0].outside for edge in edges]),
    )


@dataclass(frozen=True, slots=True)
class _Block:
    """The pixels of one view and the terms of one surface: where they lie in the design."""

    view: RimView
    surface: Surface
    borders: Sequence[Border]
    rows: slice
    columns: slice


def _blocks(
    problem: RimProblem, parts: Sequence[Sequence[Surface]], edges: Sequence[Sequence[Border]]
) -> tuple[list[_Block], Array]:
    """All blocks, and the prior precision of the terms of the light.

    The first view that shows a ring owns its terms. Every later view uses the same rows, so that
    both see the same ring, and has rows of its own for the little by which they may differ.
    """
    blocks: list[_Block] = []
    precision: list[Array] = []
    used, pixel, ring = 0, 0, None
    for view, surfaces_of_view, borders_of_view in zip(problem.views, parts, edges, strict=True):
        columns = slice(pixel, pixel + len(view.pixels.grey))
        pixel = columns.stop
        for surface in surfaces_of_view:
            rows, sigma = slice(used, used + len(surface.terms)), surface.sigma_grey
            used = rows.stop
            if surface.ring and ring is None:
                ring = rows
            elif surface.ring and ring is not None:
                blocks.append(_Block(view, surface, borders_of_view, ring, columns))
                sigma = np.full(len(surface.terms), problem.ring_variation_grey)
                sigma[0] = problem.ring_level_grey
            blocks.append(_Block(view, surface, borders_of_view, rows, columns))
            precision.append(sigma**-2.0)
    return blocks, np.concatenate(precision)
