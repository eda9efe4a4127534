"""How noisy the pixels at a rim are, and how far their errors hang together."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft2, next_fast_len, rfft2

from cellctl.geometry.pose import Array
from cellctl.vision.rim.robust import robust_sigma

IntArray = NDArray[np.intp]

_HUBER = 2.5
_LEAST_GREY = 0.35
"""Rounding to 8 bit alone leaves about this much."""
_BINS, _REACH = 36, 6
"""Sectors of azimuth, and over how many of them errors may hang together."""
_LOST = 1.4
"""What the fit takes out of these sums by bringing their total to zero."""
_SHRINK = 0.3
_CHANCE = 2.1
"""Sums over a few arcs reach this share of what independent errors give by chance alone."""
_LAG = 24
"""Distance in px over which texture is followed."""
_FEWEST_PAIRS = 40
_NEIGHBOURS = ((0, 1), (1, 0), (1, 2), (2, 1), (0, 3), (3, 0))
_WHITE_SIGMAS = 3.0
"""Steps between pixels of the band, and what their products may be by chance."""
_CLIP_GREY = 30.0
_CLIP_SIGMAS = 4.0
_LEAST_STROKE_GREY = 0.3
"""Lower strokes are not worth the work."""
_FEWEST_IN_STROKE, _FEWEST_STROKES = 4, 8


_STEPS = np.abs(np.subtract.outer(np.arange(_BINS), np.arange(_BINS)))
_KERNEL: Array = np.maximum(1.0 - np.minimum(_STEPS, _BINS - _STEPS) / _REACH, 0.0)


@dataclass(frozen=True, slots=True)
class Noise:
    """Errors of the pixels: independent ones, and strokes of the face that many pixels share."""

    weights: Array
    """One over the variance of each pixel's own error, less for outliers, shape (n,)."""
    strokes: Array
    """What each stroke adds to each pixel at one standard deviation, shape (k, n)."""
    posterior: Array
    """Covariance of the strokes' heights given the pixels, shape (k, k)."""

    @classmethod
    def of(cls, weights: Array, strokes: Array) -> "Noise":
        """With the strokes' heights still unknown."""
        normal = (strokes * weights) @ strokes.T + np.eye(len(strokes))
        return cls(weights, strokes, np.asarray(np.linalg.inv(normal)))

    def weigh(self, rows: Array) -> Array:
        """Rows (…, n) times the inverse of the errors' covariance."""
        weighted = rows * self.weights
        if len(self.strokes) == 0:
            return np.asarray(weighted)
        heights = (weighted @ self.strokes.T) @ self.posterior
        return np.asarray(weighted - (heights @ self.strokes) * self.weights)

    def own(self, residuals: Array) -> Array:
        """Residuals (n,) less the strokes in them."""
        heights = self.posterior @ (self.strokes @ (self.weights * residuals))
        return np.asarray(residuals - heights @ self.strokes)


def noise_of(residuals: Array, outside: Array, strokes: Array) -> Noise:
    """The noise that the residuals (n,) show; ``strokes`` (k, n) of unit height, k may be 0.

    The noise on the bright side (shot noise, texture) differs from that on the dark side; between
    them its variance goes with the share that the bright side covers.
    """
    bright, dark = outside > 0.95, _sigma_grey(residuals[outside < 0.05])
    own, height = _sigma_grey(residuals[bright]), 0.0
    if len(strokes):
        own, height = _own_and_strokes(residuals[bright], strokes[:, bright])
    sigma = np.sqrt(dark**2 + (own**2 - dark**2) * outside)
    seen = strokes * height if height > _LEAST_STROKE_GREY else strokes[:0]
    noise = Noise.of(sigma**-2.0, seen)
    scaled = np.abs(noise.own(residuals)) / sigma
    return Noise.of(np.minimum(1.0, _HUBER / np.maximum(scaled, 1e-9)) / sigma**2, seen)


def _own_and_strokes(residuals: Array, strokes: Array) -> tuple[float, float]:
    """Standard deviations of the pixels' own errors and of the strokes' heights.

    Analysis of variance: each pixel belongs to the stroke nearest to it.
    """
    limit = _CLIP_SIGMAS * _sigma_grey(residuals)
    clipped = np.clip(residuals, -limit, limit)
    level = strokes[: len(strokes) // 2]
    nearest = np.argmax(level, axis=0)
    count = np.bincount(nearest, minlength=len(level))
    mean = np.bincount(nearest, clipped, minlength=len(level)) / np.maximum(count, 1)
    within = clipped - mean[nearest]
    freedom = max(len(clipped) - np.count_nonzero(count), 1)
    own = max(float(np.sqrt(within @ within / freedom)), _LEAST_GREY)
    full = count >= _FEWEST_IN_STROKE
    if np.count_nonzero(full) < _FEWEST_STROKES:
        return own, 0.0
    between = float(np.mean(mean[full] ** 2 - own**2 / count[full]))
    return own, float(np.sqrt(max(between, 0.0)))


def arc_covariance(scores: Array, azimuth: Array) -> Array:
    """Covariance of the centre from what its scores sum to over arcs, shape (k, k).

    ``scores`` (k, n) is what each pixel's residual contributes to the centre. Errors of scratches
    and of an imperfect model of the light are alike in neighbouring pixels.
    """
    sector = ((azimuth + np.pi) / (2.0 * np.pi) * _BINS).astype(int) % _BINS
    sums = np.stack([np.bincount(sector, row, minlength=_BINS) for row in scores])
    return np.asarray(_LOST * sums @ _KERNEL @ sums.T)


def texture_covariance(
    place: IntArray, residuals: Array, outside: Array, influence: Array
) -> Array:
    """Covariance of the centre from the texture of the bright side, shape (k, k).

    A stroke along the rim moves the fit and leaves no residual there. But texture is the same all
    over the surface: its autocorrelation, seen where it does no harm, tells how much of it gets
    through to the centre. ``place`` (2, n) are columns and rows, ``influence`` (k, n) is the
    derivative of the centre by each pixel.
    """
    columns, rows = place - place.min(axis=1, keepdims=True)
    size = next_fast_len(int(max(columns.max(), rows.max())) + _LAG, real=True)
    bright = outside > 0.95
    clipped = np.clip(residuals, -_CLIP_GREY, _CLIP_GREY)
    shares = influence * outside
    images = np.zeros((2 + len(shares), size, size), dtype=np.float32)
    images[:, rows, columns] = np.vstack([clipped * bright, bright, shares])
    if _is_white(images[0], images[1]):
        return np.zeros((len(shares), len(shares)))
    spectra = rfft2(images)
    seen, pairs = irfft2(np.abs(spectra[:2]) ** 2, s=(size, size))
    lags = np.minimum(np.arange(size), size - np.arange(size))
    near = (lags[:, None] <= _LAG) & (lags[None, :] <= _LAG) & (pairs > _FEWEST_PAIRS)
    texture = np.where(near, seen / np.maximum(pairs, 1.0), 0.0)
    # By Parseval's theorem; the spectrum of a real image holds half of the frequencies.
    counted = np.full(spectra.shape[2], 2.0)
    counted[0] = 1.0
    counted[-1] = 2.0 - (size + 1) % 2
    passed = spectra[2:] * (rfft2(texture).real * counted)
    rows_of = (len(shares), -1)
    found = (passed.reshape(rows_of) @ spectra[2:].reshape(rows_of).conj().T).real
    return np.asarray(found / size**2)


def _is_white(residuals: Array, used: Array) -> bool:
    """Whether neighbours in an image (h, w) are as independent as noise; ``used`` is 0 or 1."""
    variance = float((residuals * residuals).sum()) / max(float(used.sum()), 1.0)
    for down, right in _NEIGHBOURS:
        here, there = slice(down, None), slice(None, -down or None)
        east, west = slice(right, None), slice(None, -right or None)
        products = float((residuals[here, east] * residuals[there, west]).sum())
        pairs = float((used[here, east] * used[there, west]).sum())
        if abs(products) > _WHITE_SIGMAS * variance * np.sqrt(max(pairs, 1.0)):
            return False
    return True


def widened(covariance: Array, seen: Array) -> Array:
    """The covariance, enlarged where ``seen`` exceeds it by more than chance."""
    root = np.linalg.cholesky(covariance)
    inverse = np.linalg.inv(root)
    whitened = inverse @ seen @ inverse.T
    even = np.trace(whitened) / len(seen) * np.eye(len(seen))
    values, vectors = np.linalg.eigh((1.0 - _SHRINK) * whitened + _SHRINK * even)
    wide = root @ vectors
    return np.asarray((wide * np.where(values > _CHANCE, values, 1.0)) @ wide.T)


def _sigma_grey(residuals: Array) -> float:
    if len(residuals) < 8:
        return _LEAST_GREY
    return max(robust_sigma(residuals), _LEAST_GREY)
