"""Figures by which a person sets a camera up: light, focus, and what both views of a head share."""

from dataclasses import dataclass

import cv2
import numpy as np

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image

SATURATED_GREY = 254
"""From this value of 8 bit on a pixel counts as saturated."""
_BLACK_GREY = 2
"""Greatest value of 8 bit of a pixel that counts as black."""
_SMOOTHING_PX = 1.0
_EDGE_SHARE = 0.999
"""Quantile of the slopes that counts as the steepest: not the maximum, which is a hot pixel."""
_MIN_SPREAD_GREY = 12
"""An image with less difference between bright and dark has no edge whose blur would say anything.
The same limit as that of images to be measured (``image_checks``)."""
_MATCH_PX = 800
"""Longer side of the reduced images in which both views are compared."""
_FEATURES, _MIN_MATCHES = 1500, 12
_GRID = 101
"""Places along each side of the left view that are looked for in the right one."""
_MATCH_RATIO, _MATCH_ERROR_PX = 0.8, 4.0
"""A match counts when its best partner is this much nearer than the second (Lowe's test), and when
it lies this near to where the common plane puts it."""


@dataclass(frozen=True, slots=True)
class ImageFigures:
    """Light and focus of one image, in grey values of 8 bit and pixels."""

    median_grey: float
    bright_grey: float
    """The grey that 99.8 % of the pixels do not exceed."""
    saturated_share: float
    black_share: float
    blur_px: float | None
    """Standard deviation of the blur of the sharpest edges: the smaller, the sharper, in any light.
    None for an image without contrast."""


def image_figures(image: Image) -> ImageFigures:
    """Figures of an image, shape (height, width)."""
    counts = np.bincount(image.ravel(), minlength=256)
    share = np.cumsum(counts) / image.size
    low, middle, high = (int(np.searchsorted(share, part)) for part in (0.002, 0.5, 0.998))
    return ImageFigures(
        median_grey=middle,
        bright_grey=high,
        saturated_share=1.0 - float(share[SATURATED_GREY - 1]),
        black_share=float(share[_BLACK_GREY]),
        blur_px=_blur_px(image) if high - low >= _MIN_SPREAD_GREY else None,
    )


def _blur_px(image: Image) -> float:
    """Blur of the sharpest edges, from the steepest slopes of the image.

    An edge of contrast c and blur s has the slope c / (s sqrt(2 pi)). The image is smoothed first,
    so that noise does not pass for an edge, and the smoothing is subtracted again as a variance.
    """
    smooth = cv2.GaussianBlur(image.astype(np.float32), (0, 0), _SMOOTHING_PX)
    slope = np.hypot(
        cv2.Sobel(smooth, cv2.CV_32F, 1, 0, scale=0.125),
        cv2.Sobel(smooth, cv2.CV_32F, 0, 1, scale=0.125),
    )
    steepest = float(np.quantile(slope[::2, ::2], _EDGE_SHARE))
    low, high = np.quantile(smooth[::2, ::2], (0.002, 0.998))
    whole_px = float(high - low) / (max(steepest, 1e-6) * np.sqrt(2.0 * np.pi))
    # The difference that the slope is taken by smooths too, by a variance of 1/2 along each axis.
    return float(np.sqrt(max(whole_px**2 - _SMOOTHING_PX**2 - 0.5, 0.0)))


def overlap_share(left: Image, right: Image) -> float | None:
    """Share of the left view that the right one sees too, on the plane that fits both best.

    None where nothing shows that they see the same: no texture, or no overlap.
    """
    matched = _matched(_reduced(left), _reduced(right))
    if matched is None or len(matched[0]) < _MIN_MATCHES:
        return None
    to_right, inliers = cv2.findHomography(*matched, cv2.RANSAC, _MATCH_ERROR_PX)
    if to_right is None or int(inliers.sum()) < _MIN_MATCHES:
        return None
    height, width = _reduced(left).shape
    columns, rows = np.meshgrid(np.linspace(0, width, _GRID), np.linspace(0, height, _GRID))
    places = np.stack([columns.ravel(), rows.ravel()], axis=1)
    seen = cv2.perspectiveTransform(places[None], to_right)[0]
    inside = (seen >= -0.5) & (seen <= np.array(_reduced(right).shape[::-1]) + 0.5)
    return float(np.mean(inside.all(axis=1)))


def _matched(left: Image, right: Image) -> tuple[Array, Array] | None:
    """Places that look alike in both, px, each of shape (n, 2)."""
    detector = cv2.ORB_create(_FEATURES)  # type: ignore[attr-defined]
    left_points, left_words = detector.detectAndCompute(left, None)
    right_points, right_words = detector.detectAndCompute(right, None)
    if left_words is None or right_words is None or len(right_words) < 2:
        return None
    pairs = cv2.BFMatcher(cv2.NORM_HAMMING).knnMatch(left_words, right_words, k=2)
    # A place with two equal partners, as on a chessboard, says nothing.
    good = [
        two[0]
        for two in pairs
        if len(two) == 2 and two[0].distance < _MATCH_RATIO * two[1].distance
    ]
    return (
        np.array([left_points[one.queryIdx].pt for one in good], dtype=float).reshape(-1, 2),
        np.array([right_points[one.trainIdx].pt for one in good], dtype=float).reshape(-1, 2),
    )


def _reduced(image: Image) -> Image:
    scale = _MATCH_PX / max(image.shape)
    if scale >= 1.0:
        return image
    return np.asarray(cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA))
