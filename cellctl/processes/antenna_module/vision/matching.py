"""Which spot is which contact: the placements of a drawing that most spots agree with.

A placement turns and moves the drawing within the plane. Spots that belong to nothing and contacts
without a spot are allowed for, so that missing contacts can be named.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.connector.arrangement import MIRROR
from cellctl.processes.antenna_module.connector.connector import Connector

_PAIRS = 6
"""Pairs of contacts from which placements are made: contacts that are missing spoil only some of
them."""
_MOST_STARTS = 200
"""Most placements that are tried, the likeliest first."""
_LENGTH_TOLERANCE = 0.04
"""Tolerance of the distance of two contacts, relative: a wrong scale is judged later, and has to be
found for that."""


@dataclass(frozen=True, slots=True, eq=False)
class Placement:
    """The drawing laid on spots: ``points = rotation @ drawing + shift``."""

    yaw_rad: float
    shift_m: Array
    spot: NDArray[np.intp]
    """Index of the spot of every contact, shape (n,); -1 without one."""
    misfit_m: float
    """Root mean square distance of the contacts that have a spot."""

    @property
    def found(self) -> int:
        """Contacts that have a spot."""
        return int(np.count_nonzero(self.spot >= 0))


def placements(drawing_m: Array, spots_m: Array, *, least: int, reach_m: float) -> list[Placement]:
    """Placements with at least ``least`` contacts on spots, best first, each another one.

    ``drawing_m`` (n, 2) and ``spots_m`` (m, 2) in metres. A spot counts for a contact within
    ``reach_m`` of its place.
    """
    found: list[Placement] = []
    for yaw, shift in _starts(drawing_m, spots_m, reach_m):
        placement = _settled(drawing_m, spots_m, yaw, shift, reach_m)
        if placement is None or placement.found < least:
            continue
        if not any(_same(placement, other, drawing_m, reach_m) for other in found):
            found.append(placement)
    return sorted(found, key=lambda item: (-item.found, item.misfit_m))


@lru_cache(maxsize=8)
def looks_alike_in_mirror(connector: Connector) -> bool:
    """Whether the contacts lie on their own mirror image, each on another one or itself to within
    half its diameter. No picture shows then whether their names run the right way."""
    # Kept for each drawing that was read: whoever measures asks, whoever reports asks again, and
    # the answer takes a tenth of a second for 15 contacts and a minute for 400.
    drawing_m, reach_m = connector.positions_m, connector.diameter_m / 2.0
    return bool(placements(drawing_m @ MIRROR, drawing_m, least=len(drawing_m), reach_m=reach_m))


def rotation(yaw_rad: float) -> Array:
    """Turn of the plane, shape (2, 2)."""
    c, s = np.cos(yaw_rad), np.sin(yaw_rad)
    return np.array([[c, -s], [s, c]])


def _starts(drawing: Array, spots: Array, reach: float) -> list[tuple[float, Array]]:
    """Placements that lay two contacts on two spots, the promising ones first."""
    starts: list[tuple[float, Array]] = []
    counts: list[int] = []
    apart = spots[None] - spots[:, None]
    lengths = np.linalg.norm(apart, axis=2)
    for one, other in _pairs(drawing):
        along = drawing[other] - drawing[one]
        length = float(np.linalg.norm(along))
        close = np.abs(lengths - length) < _LENGTH_TOLERANCE * length + reach
        np.fill_diagonal(close, val=False)
        for i, j in zip(*np.nonzero(close), strict=True):
            step = apart[i, j]
            yaw = float(np.arctan2(step[1], step[0]) - np.arctan2(along[1], along[0]))
            middle = 0.5 * (drawing[one] + drawing[other])
            shift = 0.5 * (spots[i] + spots[j]) - rotation(yaw) @ middle
            starts.append((yaw, shift))
            counts.append(_count(drawing @ rotation(yaw).T + shift, spots, reach))
    order = np.argsort(-np.array(counts), kind="stable")
    # Dirt makes many spots, and their pairs grow with the square. The true start is among the
    # first by its count, since dirt agrees with a drawing in few places.
    return [starts[index] for index in order[:_MOST_STARTS]]


def _pairs(drawing: Array) -> list[tuple[int, int]]:
    """Long pairs of contacts without a common one: a missing contact spoils one of them only."""
    apart = np.linalg.norm(drawing[None] - drawing[:, None], axis=2)
    pairs: list[tuple[int, int]] = []
    used: set[int] = set()
    for index in np.argsort(-apart, axis=None, kind="stable"):
        one, other = (int(k) for k in np.unravel_index(index, apart.shape))
        if one < other and not {one, other} & used:
            pairs.append((one, other))
            used |= {one, other}
        if len(pairs) == _PAIRS:
            break
    if len(pairs) == 1:
        # A triangle has one long pair only; its other sides stand in.
        rest = next(k for k in range(len(drawing)) if k not in used)
        pairs += [(pairs[0][0], rest), (pairs[0][1], rest)]
    return pairs


def _count(placed: Array, spots: Array, reach: float) -> int:
    nearest = np.linalg.norm(placed[:, None] - spots[None], axis=2).min(axis=1)
    return int(np.count_nonzero(nearest < reach))


def _settled(
    drawing: Array, spots: Array, yaw: float, shift: Array, reach: float
) -> Placement | None:
    """Fits all contacts that have a spot, until the assignment stays."""
    spot = np.full(len(drawing), -1)
    for _ in range(4):
        before = spot
        spot = _assign(drawing @ rotation(yaw).T + shift, spots, reach)
        with_spot = spot >= 0
        if np.count_nonzero(with_spot) < 2:
            return None
        yaw, shift = rigid(drawing[with_spot], spots[spot[with_spot]])
        if np.array_equal(spot, before):
            break
    rest = spots[spot[with_spot]] - drawing[with_spot] @ rotation(yaw).T - shift
    return Placement(yaw, shift, spot, float(np.sqrt((rest**2).sum(axis=1).mean())))


def _assign(placed: Array, spots: Array, reach: float) -> NDArray[np.intp]:
    """Nearest spot of every contact, each spot for one contact."""
    apart = np.linalg.norm(placed[:, None] - spots[None], axis=2)
    spot: NDArray[np.intp] = np.asarray(apart.argmin(axis=1))
    nearest = apart[np.arange(len(placed)), spot]
    spot[nearest > reach] = -1
    for k in np.unique(spot[spot >= 0]):
        rivals = np.flatnonzero(spot == k)
        # The loser stays without a spot for this round: it gets its own once the fit has moved.
        spot[rivals[nearest[rivals] > nearest[rivals].min()]] = -1
    return spot


def rigid(drawing: Array, points: Array) -> tuple[float, Array]:
    """Yaw and shift of the unweighted least-squares fit of points of the plane."""
    a, b = drawing - drawing.mean(axis=0), points - points.mean(axis=0)
    cross = float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum())
    yaw = float(np.arctan2(cross, float((a * b).sum())))
    return yaw, points.mean(axis=0) - rotation(yaw) @ drawing.mean(axis=0)


def _same(one: Placement, other: Placement, drawing: Array, reach: float) -> bool:
    """Whether two placements put every contact at the same place."""
    first = drawing @ rotation(one.yaw_rad).T + one.shift_m
    second = drawing @ rotation(other.yaw_rad).T + other.shift_m
    return bool(np.linalg.norm(first - second, axis=1).max() < 2.0 * reach)
