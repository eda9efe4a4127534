"""Whether a pattern of points looks the same after half a turn or in a mirror."""

import numpy as np
from scipy.spatial import KDTree

from cellctl.geometry.pose import Array

HALF_TURN: Array = -np.eye(2)
MIRROR: Array = np.diag([-1.0, 1.0])
_EIGHTHS = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
_ALL_ROUND: Array = np.column_stack([np.cos(_EIGHTHS), np.sin(_EIGHTHS)])
"""Eight directions, in each of which one point of a pattern lies farthest out."""


def asymmetry_m(points_m: Array, change: Array) -> float:
    """By how much a changed pattern differs from itself at best, m.

    ``points_m`` (n, 2), ``change`` (2, 2). The changed pattern is moved, not turned, until the
    point of it that lies farthest from any point of the pattern is as near as it can be by laying
    one point on another. Zero for a pattern that looks the same.
    """
    changed = points_m @ change.T
    shifts = (points_m[:, None] - changed[None]).reshape(-1, 2)
    tree = KDTree(points_m)
    # A connector of 400 contacts has 160 000 shifts: those are tried first at which the outermost
    # points, which no shift can make up for, lie well, until no other can be better.
    ends = changed[np.unique(np.argmax(changed @ _ALL_ROUND.T, axis=0))]
    at_least = np.asarray(tree.query(ends + shifts[:, None])[0]).max(axis=1)
    best = np.inf
    for index in np.argsort(at_least, kind="stable"):
        if at_least[index] >= best:
            break
        best = min(best, float(np.max(tree.query(changed + shifts[index])[0])))
    return float(best)


def mirror_asymmetry_m(points_m: Array, turns: int = 360) -> float:
    """The same for the mirrored pattern, turned to where it fits best, m.

    A mirrored picture may show the pattern at any angle. Patterns of n points are compared at
    angles that lay one direction between two points on another, and at even steps.
    """
    angles = np.linspace(0.0, 2.0 * np.pi, turns, endpoint=False)
    differences = (points_m[:, None] - points_m[None]).reshape(-1, 2)
    longest = differences[np.argmax(np.linalg.norm(differences, axis=1))]
    alike = differences[
        np.abs(np.linalg.norm(differences, axis=1) - np.linalg.norm(longest))
        < 0.01 * np.linalg.norm(longest)
    ]
    mirrored = MIRROR @ longest
    exact = np.arctan2(alike[:, 1], alike[:, 0]) - np.arctan2(mirrored[1], mirrored[0])
    return min(asymmetry_m(points_m, _turn(angle) @ MIRROR) for angle in (*angles, *exact))


def _turn(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])
