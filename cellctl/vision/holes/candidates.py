"""Candidates for holes: round features, found by gradient voting at reduced scale.

Every edge pixel votes for centres along its gradient at the radii in question. Arcs vote as well
as closed contours do, so a visible wall, a thread or a scratch across the rim does not hide a hole.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image

Image32 = NDArray[np.float32]

_MAX_EDGES = 12000
"""Most edge pixels that vote; see ``_edges``."""
_SUPPORT = 0.42
"""Share of the circumference that must vote for a centre. The fit of the rim needs 0.55 later
(``rim.roi``); here, at reduced scale, rounding costs some of the votes."""
_ARC_SUPPORT = 0.6
"""A feature that overlaps another one needs this share of its support, or it is an arc of it."""
_NOISE_FACTOR = 5.0
"""Edges are steeper than this many times the slope that noise and texture make."""


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """A round feature, coarsely located."""

    centre_px: Array
    """Shape (2,)."""
    radius_px: float
    support: float
    """Share of the circumference with an edge that points at the centre."""


def find_candidates(
    image: Image,
    radii_px: tuple[float, float],
    *,
    bright: bool = False,
    limit: int = 60,
) -> list[Candidate]:
    """Dark (or bright) discs with a radius in the given range, best supported first."""
    found: list[Candidate] = []
    for octave in _octaves(*radii_px):
        found += _at_one_scale(image, octave, bright=bright, limit=limit)
    return sorted(found, key=lambda item: -item.support)[:limit]


def outermost(candidates: Iterable[Candidate]) -> list[Candidate]:
    """One for each place: of concentric circles, such as hole and countersink, the largest."""
    found: list[Candidate] = []
    for one in sorted(candidates, key=lambda item: -item.radius_px):
        apart = (np.linalg.norm(one.centre_px - other.centre_px) for other in found)
        if all(away > other.radius_px for away, other in zip(apart, found, strict=True)):
            found.append(one)
    return found


def _octaves(smallest: float, largest: float) -> list[tuple[float, float]]:
    """The range in parts of a factor of two at most: large circles are found at small scale."""
    count = max(1, int(np.ceil(np.log2(largest / smallest) - 1e-9)))
    ends = np.geomspace(smallest, largest, count + 1)
    return [(float(low), float(high)) for low, high in pairwise(ends)]


def _at_one_scale(
    image: Image, radii_px: tuple[float, float], *, bright: bool, limit: int
) -> list[Candidate]:
    shrink = _shrink(radii_px[0])
    small = _reduced(image, shrink)
    radii = _radii(radii_px[0] / shrink, radii_px[1] / shrink)
    edges = _edges(small, bright=bright)
    if edges is None:
        return []
    votes = _vote(small.shape, edges, radii)
    found = _peaks(votes, radii, limit)
    return [
        # Pixel centres lie at integers, so the corner of the image is at -0.5 at every scale.
        # Without the two halves all places would be off by half a block.
        Candidate((centre + 0.5) * shrink - 0.5, float(radius * shrink), support)
        for centre, radius, support in found
    ]


def _shrink(smallest_radius_px: float) -> int:
    """Largest reduction that leaves a radius of 4 px."""
    for shrink in (4, 3, 2):
        if smallest_radius_px / shrink >= 4.0:
            return shrink
    return 1


def _reduced(image: Image, shrink: int) -> Image32:
    height, width = image.shape
    size = (width // shrink, height // shrink)
    # Whole blocks only: otherwise the reduction would stretch the image by a fraction of a block.
    cropped = image[: size[1] * shrink, : size[0] * shrink]
    small = cv2.resize(cropped, size, interpolation=cv2.INTER_AREA) if shrink > 1 else cropped
    return np.asarray(cv2.GaussianBlur(small.astype(np.float32), (0, 0), 0.8), dtype=np.float32)


def _radii(smallest: float, largest: float) -> Array:
    count = max(2, int(np.ceil((largest - smallest) / 0.8)) + 1)
    return np.linspace(smallest, largest, count)


def _edges(small: Image32, *, bright: bool) -> tuple[Image32, Image32] | None:
    """Positions and unit vectors towards the inside of a feature, the strongest only."""
    gx = cv2.Sobel(small, cv2.CV_32F, 1, 0, scale=0.125)
    gy = cv2.Sobel(small, cv2.CV_32F, 0, 1, scale=0.125)
    strength = cv2.magnitude(gx, gy)
    # Edges cover a small part of an image, so the median of the gradient measures noise and texture
    # alone.
    floor = max(_NOISE_FACTOR * float(np.median(strength)) * 0.6, 1.5)
    rows, columns = np.nonzero(strength > floor)
    if len(rows) == 0:
        return None
    value = strength[rows, columns]
    # A textured face has edges everywhere. The limit bounds the time of the search; rims
    # are among the strongest edges.
    if len(rows) > _MAX_EDGES:
        keep = np.argpartition(value, -_MAX_EDGES)[-_MAX_EDGES:]
        rows, columns, value = rows[keep], columns[keep], value[keep]
    sign = 1.0 if bright else -1.0
    inward = np.column_stack([gx[rows, columns], gy[rows, columns]]) * (sign / value)[:, None]
    positions = np.column_stack([columns, rows]).astype(np.float32)
    return positions, inward.astype(np.float32)


def _vote(shape: tuple[int, ...], edges: tuple[Image32, Image32], radii: Array) -> Image32:
    """Support in [0, ~1] for a centre at each pixel and radius, shape (len(radii), h, w)."""
    positions, inward = edges
    height, width = shape
    votes = np.empty((len(radii), height, width), dtype=np.float32)
    # Few pixels of an image are voted for. At full scale there are millions of them, so that each
    # pass over all, and each new array, would take longer than the votes.
    counts = np.zeros(height * width, dtype=np.uint16)
    for index, radius in enumerate(radii):
        centres = np.rint(positions + inward * radius).astype(np.intp)
        inside = (centres >= 0).all(axis=1) & (centres[:, 0] < width) & (centres[:, 1] < height)
        flat = centres[inside, 1] * width + centres[inside, 0]
        np.add.at(counts, flat, np.uint16(1))
        # Rounding and the noise of the gradient's direction scatter the votes of one circle over
        # neighbouring pixels.
        image = counts.reshape(height, width)
        cv2.boxFilter(image, cv2.CV_32F, (3, 3), dst=votes[index], normalize=False)
        counts[flat] = 0
        # An edge is about two pixels wide, so a full circle gathers some 4 π r votes.
        votes[index] /= np.float32(4.0 * np.pi * radius)
    return votes


def _peaks(votes: Image32, radii: Array, limit: int) -> list[tuple[Array, float, float]]:
    best = votes.max(axis=0)
    size = 2 * max(1, int(radii[0] * 0.5)) + 1
    highest = cv2.dilate(best, np.ones((size, size), np.uint8))
    rows, columns = np.nonzero((best >= highest) & (best > _SUPPORT))
    order = np.argsort(-best[rows, columns])
    found: list[tuple[Array, float, float]] = []
    for row, column in zip(rows[order], columns[order], strict=True):
        centre, support = np.array([column, row], dtype=float), float(best[row, column])
        if not any(_shadowed(centre, support, stronger) for stronger in found):
            along = votes[:, row, column]
            found += [
                (centre, _radius(along, radii, index), float(along[index]))
                for index in _maxima(along)
            ]
        if len(found) >= limit:
            break
    return found[:limit]


def _maxima(votes: Image32) -> NDArray[np.intp]:
    """Concentric circles: the radii with more votes than their neighbours, the best first."""
    padded = np.pad(votes, 1)
    peaks = np.nonzero((votes >= padded[:-2]) & (votes > padded[2:]) & (votes > _SUPPORT))[0]
    return peaks[np.argsort(-votes[peaks])]


def _radius(votes: Image32, radii: Array, index: int) -> float:
    around = slice(max(index - 1, 0), index + 2)
    weights = np.maximum(votes[around] - 0.4 * votes[index], 0.0)
    return float(weights @ radii[around] / weights.sum())


def _shadowed(centre: Array, support: float, stronger: tuple[Array, float, float]) -> bool:
    """Whether a peak is an arc of a much better supported feature that it overlaps."""
    near = float(np.linalg.norm(centre - stronger[0])) < 1.6 * stronger[1]
    return near and support < _ARC_SUPPORT * stronger[2]
