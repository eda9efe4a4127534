"""Normal matrices: small, symmetric, of unknowns in very different units."""

import numpy as np

from cellctl.geometry.pose import Array


def add_to_diagonal(matrix: Array, values: Array | float) -> None:
    """Add to the diagonal of a square matrix, in place."""
    matrix.flat[:: len(matrix) + 1] += values


def with_unit_diagonal(normal: Array) -> tuple[Array, Array]:
    """A normal matrix (n, n) for unknowns in units of their own size (n,), and these sizes."""
    size = np.sqrt(normal.diagonal()) + 1e-12
    return normal / (size[:, None] * size), size
