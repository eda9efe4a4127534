"""The blur of an edge: its width, by the direction across the edge, and how heavy its tails are.

Motion during the exposure and astigmatism blur along one direction more than across it. Any such
point spread has, seen across an edge of direction n, the variance nᵀ S n with a symmetric matrix S
of three numbers. A circle shows edges of all directions, so the pixels tell all three. A motion of
constant speed is symmetric about the middle of the exposure, hence it does not shift the rim.

The spread of a lens out of focus has shoulders and no tails, that of a dirty one has tails: the
first term after the Gaussian in the series of Gram and Charlier, by the excess kurtosis.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from cellctl.geometry.pose import Array

SIZE = 4
"""Numbers in ``Blur.vector``."""
_LIMITS_PX, _MOST_STRETCH, _TAIL_LIMITS = (0.35, 4.0), 0.9, (-1.0, 2.0)
"""Outside of these the model means something else: an edge as sharp as a pixel cannot be, a line
instead of a spot, or a grey that does not rise all the way. The pixel alone blurs by 0.29 px (a box
of one pixel has the variance 1/12), and a disc has a kurtosis of -1."""
_SQRT_2PI = float(np.sqrt(2.0 * np.pi))


@dataclass(frozen=True, slots=True, eq=False)
class Blur:
    """The second moments of a point spread in the image."""

    sigma_px: float
    """Root of the mean variance over all directions."""
    stretch: tuple[float, float] = (0.0, 0.0)
    """Relative difference of the variance along x from the mean, and the same along the diagonal:
    cosine and sine of twice the direction of most blur, times how uneven it is."""

    tail: float = 0.0
    """Excess kurtosis of the spread: below 0 for a disc or a line, above 0 with a halo."""

    @property
    def vector(self) -> Array:
        """Its four numbers, as the fit varies them."""
        return np.array([self.sigma_px, *self.stretch, self.tail])

    @classmethod
    def possible(cls, vector: Array) -> "Blur":
        """The nearest one inside what is physically possible."""
        sigma_px = min(max(float(vector[0]), _LIMITS_PX[0]), _LIMITS_PX[1])
        size = float(np.hypot(vector[1], vector[2]))
        shrink = min(1.0, _MOST_STRETCH / max(size, 1e-12))
        tail = min(max(float(vector[3]), _TAIL_LIMITS[0]), _TAIL_LIMITS[1])
        return cls(sigma_px, (float(vector[1]) * shrink, float(vector[2]) * shrink), tail)

    @property
    def widest_px(self) -> float:
        """Standard deviation along the direction of most blur."""
        return self.sigma_px * float(np.sqrt(1.0 + np.hypot(*self.stretch)))

    def spread(self, vectors: Array) -> Array:
        """The matrix of second moments times image vectors (2, n), in px squared."""
        along, diagonal = self.stretch
        moments = self.sigma_px**2 * np.array([[1.0 + along, diagonal], [diagonal, 1.0 - along]])
        return np.asarray(moments @ vectors)

    def across(self, direction: Array) -> "EdgeBlur":
        """The blur that edges show whose unit normals in the image are ``direction`` (2, n)."""
        x, y = direction
        double = np.stack([x * x - y * y, 2.0 * x * y])
        uneven = self.stretch[0] * double[0] + self.stretch[1] * double[1]
        return EdgeBlur(self, np.sqrt(1.0 + uneven), double)


START_BLUR = Blur(1.0)
"""A lens in focus, where nothing is known yet."""


@dataclass(frozen=True, slots=True, eq=False)
class EdgeBlur:
    """The blur across edges of given directions."""

    blur: Blur
    ratio: Array
    """Standard deviation across the edge over ``Blur.sigma_px``, shape (n,)."""
    double: Array
    """Cosine and sine of twice the direction across the edge, shape (2, n)."""

    def bend(self) -> Array:
        """How far the half level of a blurred disc of radius r lies inside its edge, times r, px².

        It is half the variance along the edge: blur takes more light from the outside of a curved
        edge than from its inside. Without this the radius would come out too small.
        """
        return np.asarray(0.5 * self.blur.sigma_px**2 * (2.0 - self.ratio**2))

    def outside(self, distance_px: Array) -> Array:
        """Share of each pixel outside an edge at these distances (…, n), positive outside."""
        z = distance_px / (self.blur.sigma_px * self.ratio)
        third = z * (z * z - 3.0) * np.exp(-0.5 * z * z) / _SQRT_2PI
        return np.asarray(ndtr(z) - self.blur.tail / 24.0 * third)

    def with_derivatives(self, distance_px: Array) -> tuple[Array, Array, Array]:
        """``outside``, and its derivatives by the distance (n,) and by ``Blur.vector`` (4, n).

        One function for all three, because this is the inner loop of every fit.
        """
        sigma_px = self.blur.sigma_px * self.ratio
        z = distance_px / sigma_px
        square, normal = z * z, np.exp(-0.5 * z * z) / _SQRT_2PI
        by_tail = z * (3.0 - square) * normal / 24.0
        fourth = square * (square - 6.0) + 3.0
        density = normal * (1.0 + self.blur.tail / 24.0 * fourth) / sigma_px
        by_sigma = -z * density
        by_blur = np.empty((SIZE, len(z)))
        by_blur[0] = by_sigma * self.ratio
        by_blur[1:3] = self.double * (by_sigma * (0.5 * self.blur.sigma_px / self.ratio))
        by_blur[3] = by_tail
        return np.asarray(ndtr(z) + self.blur.tail * by_tail), density, by_blur
