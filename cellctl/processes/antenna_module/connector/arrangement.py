"""Whether a pattern of points looks the same after half a turn or in a mirror."""

import numpy as np

from cellctl.geometry.pose import Array

HALF_TURN: Array = -np.eye(2)
MIRROR: Array = np.diag([-1.0, 1.0])


def asymmetry_m(points_m: Array, change: Array) -> float:
    """By how much a changed pattern differs from itself at best, m.

    ``points_m`` (n, 2), ``change`` (2, 2). The changed pattern is moved, not turned, until the
    point of it that lies farthest from any point of the pattern is as near as it can be by laying
    one point on another. Zero for a pattern that looks the same.
    """
    changed = points_m @ change.T
    shifts = (points_m[:, None] - changed[None]).reshape(-1, 2)
    # Distances of every changed and moved point from every point, (shifts, n, n).
    apart = np.linalg.norm(
        changed[None, :, None] + shifts[:, None, None] - points_m[None, None], axis=3
    )
    return float(apart.min(axis=2).max(axis=1).min())


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
