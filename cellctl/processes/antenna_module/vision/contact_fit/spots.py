"""Finds round spots of one size, bright or dark: places where a contact may be."""

from dataclasses import dataclass

import cv2
import numpy as np

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image

_RADIUS_PX = 5.0
"""The image is made smaller until a spot has this radius: more would only cost time."""
_INNER = 0.55
"""Radius of the disc that is averaged, of the spot's."""
_AROUND = 1.7
"""Distance of the places that a spot is compared with, of its radius."""
_SECTORS = 12
"""Directions in which a spot is compared with its surroundings."""
_LEAST_CONTRAST = 5.0
"""Grey levels; less is noise of the sensor."""
_SHARE = 0.25
"""Spots with less contrast than this share of the strong ones are texture."""
_MOST = 80
"""Most spots that are kept, the strongest first: dirt makes many, and their pairs grow with the
square."""


@dataclass(frozen=True, slots=True, eq=False)
class Spots:
    """Places in the image, strongest first."""

    px: Array
    """Shape (n, 2)."""
    contrast: Array
    """Grey levels by which a spot differs from everything round it, shape (n,)."""


def find_spots(image: Image, radius_px: float, *, bright: bool, typical: int) -> Spots:
    """Spots of about this radius; ``typical`` of them are expected.

    A spot is brighter (or darker) than the brightest (darkest) of the places all round it, so that
    edges and corners of larger things do not count.
    """
    shrink = max(radius_px / _RADIUS_PX, 1.0)
    size = (round(image.shape[1] / shrink), round(image.shape[0] / shrink))
    small = image if shrink == 1.0 else cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    radius = radius_px / shrink
    score = _score(small.astype(np.float32) * (1.0 if bright else -1.0), radius)
    window = 2 * int(np.ceil(1.5 * radius)) + 1
    peaks = (score >= cv2.dilate(score, np.ones((window, window)))) & (score > _LEAST_CONTRAST)
    rows, columns = np.nonzero(peaks)
    order = np.argsort(-score[rows, columns], kind="stable")[:_MOST]
    contrast = score[rows, columns][order].astype(float)
    if len(contrast) == 0:
        return Spots(np.empty((0, 2)), contrast)
    # Of the strong ones the typical: one glaring reflection must not hide all contacts.
    strong = float(np.median(contrast[: max(typical, 1)]))
    keep = contrast > _SHARE * strong
    scale = np.array([image.shape[1] / small.shape[1], image.shape[0] / small.shape[0]])
    px = (np.column_stack([columns, rows])[order] + 0.5) * scale - 0.5
    return Spots(px[keep], contrast[keep])


def _score(image: np.ndarray, radius: float) -> np.ndarray:
    """Mean of a disc at every pixel less the greatest mean of discs round it."""
    inner = max(_INNER * radius, 1.0)
    reach = int(np.ceil(inner))
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    disc = (x * x + y * y <= inner * inner).astype(np.float32)
    mean = cv2.filter2D(image, -1, disc / disc.sum(), borderType=cv2.BORDER_REPLICATE)
    border = int(np.ceil(_AROUND * radius)) + 1
    padded = cv2.copyMakeBorder(mean, border, border, border, border, cv2.BORDER_REPLICATE)
    height, width = image.shape
    highest = np.full_like(mean, -np.inf)
    for angle in np.linspace(0.0, 2.0 * np.pi, _SECTORS, endpoint=False):
        row = border + round(_AROUND * radius * float(np.sin(angle)))
        column = border + round(_AROUND * radius * float(np.cos(angle)))
        np.maximum(highest, padded[row : row + height, column : column + width], out=highest)
    return np.asarray(mean - highest)
