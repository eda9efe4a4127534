"""How noisy the pixels at a rim are, and how far their errors hang together."""

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft2, rfft2

from cellctl.geometry.pose import Array

IntArray = NDArray[np.intp]

_HUBER = 2.5
_LEAST_GREY = 0.35
"""Rounding to 8 bit alone leaves about this much."""
_BINS, _REACH = 36, 6
"""Sectors of azimuth, and over how many of them errors may hang together."""
_LOST = 1.4
"""What the fit takes out of these sums by bringing their total to zero."""
_SHRINK = 0.3
_LAG = 24
"""Distance in px over which texture is followed."""
_FEWEST_PAIRS = 40
_CLIP_GREY = 30.0


_STEPS = np.abs(np.subtract.outer(np.arange(_BINS), np.arange(_BINS)))
_KERNEL: Array = np.maximum(1.0 - np.minimum(_STEPS, _BINS - _STEPS) / _REACH, 0.0)


def weights_of(residuals: Array, outside: Array) -> Array:
    """Weights of the pixels: one over the variance there, less for outliers, shape (n,).

    The noise on the bright side (shot noise, texture) differs from that on the dark side; between
    them its variance goes with the share that the bright side covers.
    """
    bright = _robust_sigma(residuals[outside > 0.95])
    dark = _robust_sigma(residuals[outside < 0.05])
    sigma = np.sqrt(dark**2 + (bright**2 - dark**2) * outside)
    scaled = np.abs(residuals) / sigma
    return np.asarray(np.minimum(1.0, _HUBER / np.maximum(scaled, 1e-9)) / sigma**2)


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
    size = 2 * (int(max(columns.max(), rows.max())) // 2) + _LAG
    bright = outside > 0.95
    clipped = np.clip(residuals, -_CLIP_GREY, _CLIP_GREY)

    def spectrum(values: Array) -> NDArray[np.complex128]:
        image = np.zeros((size, size))
        image[rows, columns] = values
        return np.asarray(rfft2(image))

    def correlation(first: NDArray[np.complex128], second: NDArray[np.complex128]) -> Array:
        return np.asarray(irfft2(np.conj(first) * second, s=(size, size)))

    seen, mask = spectrum(clipped * bright), spectrum(bright.astype(float))
    pairs = correlation(mask, mask)
    lags = np.minimum(np.arange(size), size - np.arange(size))
    near = (lags[:, None] <= _LAG) & (lags[None, :] <= _LAG) & (pairs > _FEWEST_PAIRS)
    texture = np.where(near, correlation(seen, seen) / np.maximum(pairs, 1.0), 0.0)
    spread = rfft2(texture)
    shares = influence * outside
    passed = np.stack(
        [irfft2(spectrum(row) * spread, s=(size, size))[rows, columns] for row in shares]
    )
    found = shares @ passed.T
    return np.asarray(0.5 * (found + found.T))


def widened(covariance: Array, seen: Array) -> Array:
    """The covariance, enlarged where ``seen`` exceeds it; partly in all directions alike."""
    root = np.linalg.cholesky(covariance)
    inverse = np.linalg.inv(root)
    whitened = inverse @ seen @ inverse.T
    whitened = (1.0 - _SHRINK) * whitened + _SHRINK * np.trace(whitened) / len(seen) * np.eye(
        len(seen)
    )
    values, vectors = np.linalg.eigh(whitened)
    wide = root @ vectors
    return np.asarray((wide * np.maximum(values, 1.0)) @ wide.T)


def _robust_sigma(residuals: Array) -> float:
    if len(residuals) < 8:
        return _LEAST_GREY
    return max(1.4826 * float(np.median(np.abs(residuals))), _LEAST_GREY)
