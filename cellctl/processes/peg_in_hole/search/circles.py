"""Circles through points of a rim: the centre of a plug from where the peg left or met it."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def circle_through(points: Array) -> tuple[Array, float, float]:
    """Centre (2,), radius and root mean square residual of the circle nearest to points (n, 2).

    Algebraic least squares; exact for three points. Raises ``numpy.linalg.LinAlgError`` for points
    on one line.
    """
    middle = points.mean(axis=0)
    local = points - middle
    design = np.column_stack([2 * local, np.ones(len(local))])
    squares = np.sum(local**2, axis=1)
    solution, _, rank, _ = np.linalg.lstsq(design, squares, rcond=None)
    if rank < 3:
        raise np.linalg.LinAlgError("points on one line")
    centre = solution[:2]
    radius = float(np.sqrt(solution[2] + centre @ centre))
    residuals = np.linalg.norm(local - centre, axis=1) - radius
    return middle + centre, radius, float(np.sqrt(np.mean(residuals**2)))


def turned(direction: Array, angle_rad: float) -> Array:
    """A vector (2,) turned from x towards y."""
    cos, sin = np.cos(angle_rad), np.sin(angle_rad)
    return np.array([[cos, -sin], [sin, cos]]) @ direction
