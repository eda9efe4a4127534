"""Noise of the pixels at a rim: their own, and the lay of the face that they share.

The lay is the direction of the strokes that a tool leaves on a machined face (ISO 21920-1). A
stroke along the rim shifts its edge and leaves no residual there. It does not end at the rim,
though: seen beside it, it tells how much it adds at it. To the fit strokes are therefore noise that
is correlated along the lay and not across it.
"""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, vstack

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.plane_patch import PlanePatch

_SIGMA_OVER_MEDIAN = 1.4826
"""Standard deviation over the median of the absolute values, for normally distributed errors."""
_HUBER = 2.5
"""Residuals beyond so many standard deviations lose weight (Huber): scratches, reflexes, dust."""
_LEAST_GREY = 0.35
"""Rounding to 8 bit alone leaves about this much."""
BRIGHT, DARK = 0.95, 0.05
"""Shares outside the rim from which on a pixel belongs to one side."""
_CLIP_SIGMAS = 4.0
"""Residuals are clipped here before strokes are told from pixels: a scratch is no stroke."""
_LEAST_STROKE_GREY = 0.3
"""Lower strokes are not worth the work."""
_FEWEST_IN_STROKE, _FEWEST_STROKES = 4, 8
"""A stroke is judged by so many pixels at least, and the height of strokes by so many of them."""

_LAY_REACH_PX = 14.0
"""Distance beyond the rim up to which the lay of the face is looked for."""
_ANISOTROPY = 0.2
"""From this share of directed gradients on there is a lay; noise alone stays below a tenth."""
_GRADIENT_CLIP = 3.0
"""Gradients are clipped at this multiple of their median; see ``surface_lay``."""
_ALONG = 0.3
"""Change of a stroke along its length over one radius, as a share of its height."""


def median(values: Array) -> float:
    """The upper median of values of shape (n,), n > 0; far faster than ``np.median`` on few."""
    middle = len(values) // 2
    return float(np.partition(values, middle)[middle])


def robust_sigma(residuals: Array) -> float:
    """Standard deviation of residuals about zero, shape (n,), n > 0, unmoved by outliers."""
    return _SIGMA_OVER_MEDIAN * median(np.abs(residuals))


@dataclass(frozen=True, slots=True, eq=False)
class PixelNoise:
    """Errors of the pixels: independent ones, and those that many pixels share: strokes of the
    face, and arcs of a worn rim."""

    weights: Array
    """One over the variance of each pixel's own error, less for outliers, shape (n,)."""
    strokes: csr_array
    """Grey that each stroke or arc adds to each pixel at one standard deviation, shape (k, n).

    Sparse, because no more than two strokes reach a pixel: dense rows take most of a fit's time.
    """
    posterior: Array
    """Covariance of the strokes' heights given the pixels, shape (k, k)."""
    variance: Array
    """Of each pixel's own error, outlier or not, shape (n,)."""
    left_out: NDArray[np.bool_]
    """Pixels of arcs that have left the fit, shape (n,)."""

    @property
    def share_left_out(self) -> float:
        """Share of the rim that has left the fit."""
        return float(np.mean(self.left_out))

    @classmethod
    def of(cls, weights: Array, strokes: csr_array) -> "PixelNoise":
        """Noise from its parts, with the posterior of the strokes' heights computed."""
        normal = (csr_array(strokes * weights) @ strokes.T).toarray() + np.eye(strokes.shape[0])
        inverse = np.asarray(np.linalg.inv(normal))
        return cls(weights, strokes, inverse, 1.0 / weights, np.zeros(len(weights), dtype=bool))

    def weigh(self, rows: Array) -> Array:
        """Rows (…, n) times the inverse of the errors' covariance.

        The covariance is diagonal plus one term for each stroke; by Woodbury's identity its inverse
        needs only the small matrix ``posterior``.
        """
        weighted = rows * self.weights
        if self.strokes.shape[0] == 0:
            return np.asarray(weighted)
        heights = (weighted @ self.strokes.T) @ self.posterior
        return np.asarray(weighted - (heights @ self.strokes) * self.weights)

    def own(self, residuals: Array) -> Array:
        """Residuals (n,) less the strokes in them."""
        heights = self.posterior @ (self.strokes @ (self.weights * residuals))
        return np.asarray(residuals - heights @ self.strokes)


def noise_of(residuals: Array, outside: Array, strokes: csr_array) -> PixelNoise:
    """The noise that the residuals (n,) show; ``strokes`` (k, n) of unit height, k may be 0.

    The noise on the bright side (shot noise, texture) differs from that on the dark side; between
    them its variance goes with ``outside``, the share of each pixel that the bright side covers.
    """
    bright, dark = outside > BRIGHT, _sigma_grey(residuals[outside < DARK])
    own, height = _sigma_grey(residuals[bright]), 0.0
    if strokes.shape[0]:
        own, height = _own_and_strokes(residuals[bright], strokes[:, bright])
    sigma = np.sqrt(dark**2 + (own**2 - dark**2) * outside)
    seen = csr_array(strokes * height) if height > _LEAST_STROKE_GREY else strokes[:0]
    return less_outliers(residuals, sigma**2, seen)


def less_outliers(residuals: Array, variance: Array, strokes: csr_array) -> PixelNoise:
    """Noise in which outliers weigh less, where ``strokes`` (k, n) do not explain them.

    ``variance`` (n,) is that of the pixels' own errors.
    """
    scaled = np.abs(PixelNoise.of(1.0 / variance, strokes).own(residuals)) / np.sqrt(variance)
    weights = np.minimum(1.0, _HUBER / np.maximum(scaled, 1e-9)) / variance
    return replace(PixelNoise.of(weights, strokes), variance=variance)


def _own_and_strokes(residuals: Array, strokes: csr_array) -> tuple[float, float]:
    """Standard deviations of the pixels' own errors and of the strokes' heights.

    One-way analysis of variance: each pixel belongs to the stroke nearest to it.
    """
    limit = _CLIP_SIGMAS * _sigma_grey(residuals)
    clipped = np.clip(residuals, -limit, limit)
    # The first half of the rows are the levels of the strokes, the second their slopes along the
    # lay.
    strokes_seen = strokes.shape[0] // 2
    nearest = _largest_in_columns(strokes[:strokes_seen])
    count = np.bincount(nearest, minlength=strokes_seen)
    mean = np.bincount(nearest, clipped, minlength=strokes_seen) / np.maximum(count, 1)
    within = clipped - mean[nearest]
    freedom = max(len(clipped) - int(np.count_nonzero(count)), 1)
    own = max(float(np.sqrt(within @ within / freedom)), _LEAST_GREY)
    full = count >= _FEWEST_IN_STROKE
    if np.count_nonzero(full) < _FEWEST_STROKES:
        return own, 0.0
    # The mean of a stroke scatters by the pixels' own errors too; what exceeds that is the
    # strokes'.
    between = float(np.mean(mean[full] ** 2 - own**2 / count[full]))
    return own, float(np.sqrt(max(between, 0.0)))


def _largest_in_columns(matrix: csr_array) -> "np.ndarray[tuple[int], np.dtype[np.intp]]":
    """Row of the largest entry of each column, shape (n,); 0 for a column without entries.

    The method ``argmax`` of a sparse array visits one column at a time and is far slower.
    """
    entries = matrix.tocoo()
    row, column = entries.coords
    order = np.argsort(entries.data)
    largest = np.zeros(matrix.shape[1], dtype=np.intp)
    # Of several values that are assigned to one place the last one stays.
    largest[column[order]] = row[order]
    return largest


def _sigma_grey(residuals: Array) -> float:
    if len(residuals) < 8:
        return _LEAST_GREY
    return max(robust_sigma(residuals), _LEAST_GREY)


def surface_lay(image: Image, patch: PlanePatch, middle_px: Array, clear_px: float) -> Array | None:
    """Unit vector across the lay in the plane, shape (2,); None where the face has no lay.

    Looks at the ring from ``clear_px`` to a little more round a hole: the structure tensor of its
    grey values, with strong edges clipped so that a scratch or a neighbouring hole does not decide.
    """
    reach = clear_px + _LAY_REACH_PX
    x0, y0 = np.maximum(np.floor(middle_px - reach).astype(int), 0)
    x1, y1 = np.ceil(middle_px + reach).astype(int) + 1
    cut = cv2.GaussianBlur(image[y0:y1, x0:x1].astype(np.float32), (0, 0), 0.8)
    rows, columns = np.indices(cut.shape)
    distance = np.hypot(columns + x0 - middle_px[0], rows + y0 - middle_px[1])
    ring = (distance > clear_px) & (distance < reach)
    gradient = np.stack(
        [cv2.Sobel(cut, cv2.CV_32F, 1, 0)[ring], cv2.Sobel(cut, cv2.CV_32F, 0, 1)[ring]]
    ).astype(float)
    # An even change of brightness over the face is shading, not a lay.
    gradient -= gradient.mean(axis=1, keepdims=True)
    size = np.hypot(*gradient)
    limit = _GRADIENT_CLIP * max(median(size), 1e-3)
    gradient *= np.minimum(1.0, limit / np.maximum(size, 1e-9))
    # Gradients are covectors: they go to the plane by the transposed inverse of the Jacobian.
    _, jacobian = patch.from_px(middle_px[:1], middle_px[1:])
    in_plane = np.linalg.solve(jacobian[:, :, 0].T * (1.0 / patch.unit_px), gradient)
    values, vectors = np.linalg.eigh(in_plane @ in_plane.T)
    if values[1] - values[0] < _ANISOTROPY * values.sum():
        return None
    return np.asarray(vectors[:, 1])


def no_strokes(pixels: int) -> csr_array:
    """The pattern of a face without a lay, shape (0, n)."""
    return csr_array((0, pixels))


def stroke_pattern(offsets_px: Array, across: Array, radius_px: float) -> csr_array:
    """Strokes a pixel wide that change slowly along the lay, shape (2 k, n).

    ``offsets_px`` (2, n) lie in the plane, from the centre of the rim.
    """
    position = across @ offsets_px
    along = np.array([-across[1], across[0]]) @ offsets_px / radius_px
    first = np.floor(position.min())
    knots = max(int(np.ceil(position.max()) - first), 1) + 1
    # A pixel lies between two knots and is reached by these two strokes, in proportion.
    below = np.minimum((position - first).astype(int), knots - 2)
    share = position - first - below
    pixels = np.arange(len(position))
    level = csr_array(
        (
            np.concatenate([1.0 - share, share]),
            (np.concatenate([below, below + 1]), np.concatenate([pixels, pixels])),
        ),
        shape=(knots, len(position)),
    )
    return csr_array(vstack([level, level * (_ALONG * along)]))
