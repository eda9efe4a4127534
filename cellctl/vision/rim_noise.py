"""How noisy the pixels at a rim are, and how far their errors hang together."""

import numpy as np

from cellctl.geometry.pose import Array

_HUBER = 2.5
_LEAST_GREY = 0.35
"""Rounding to 8 bit alone leaves about this much."""
_SECTORS = 16
_SHRINK = 0.4


def weights_of(residuals: Array, outside: Array) -> Array:
    """Weights of the pixels: one over the variance there, less for outliers, shape (n,).

    The noise on the bright side (shot noise, texture) differs from that on the dark side; between
    them it goes with the square of the share that the bright side covers.
    """
    bright = _robust_sigma(residuals[outside > 0.95])
    dark = _robust_sigma(residuals[outside < 0.05])
    sigma = np.sqrt(dark**2 * (1.0 - outside) ** 2 + bright**2 * outside**2)
    sigma = np.maximum(sigma, 0.5 * (dark + bright) * 0.5)
    scaled = np.abs(residuals) / sigma
    return np.asarray(np.minimum(1.0, _HUBER / np.maximum(scaled, 1e-9)) / sigma**2)


def scatter_factor(scores: Array, azimuth: Array, covariance: Array) -> Array:
    """Matrix that widens a covariance for errors that are not independent, shape (k, k).

    ``scores`` (k, n) is what each pixel's residual contributes to the centre. Errors of texture,
    scratches and an imperfect model of the light are alike in neighbouring pixels: their sums over
    sectors of azimuth scatter more than ``covariance`` says. Returned is F with F C Fᵀ ≥ C.
    """
    sector = ((azimuth + np.pi) / (2.0 * np.pi) * _SECTORS).astype(int) % _SECTORS
    sums = np.stack([np.bincount(sector, row, minlength=_SECTORS) for row in scores])
    seen = sums @ sums.T * (_SECTORS / (_SECTORS - 3.0))
    root = np.linalg.cholesky(covariance)
    whitened = np.linalg.solve(root, np.linalg.solve(root, seen).T)
    whitened = (1.0 - _SHRINK) * whitened + _SHRINK * np.trace(whitened) / len(seen) * np.eye(
        len(seen)
    )
    values, vectors = np.linalg.eigh(whitened)
    wide = vectors @ np.diag(np.sqrt(np.maximum(values, 1.0))) @ vectors.T
    return np.asarray(root @ wide @ np.linalg.inv(root))


def _robust_sigma(residuals: Array) -> float:
    if len(residuals) < 8:
        return _LEAST_GREY
    return max(1.4826 * float(np.median(np.abs(residuals))), _LEAST_GREY)
