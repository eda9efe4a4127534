"""Poses as the controller writes them: x, y, z in metres and three angles in radians."""

from math import degrees, radians

from scipy.spatial.transform import Rotation

from fakes.world.frames import MM, Array, matrix_to_written, written_matrix


def to_six(matrix: Array, *, moving_axes: bool = False) -> list[float]:
    """Six numbers of a 4x4 matrix; angles about the fixed axes x, y, z unless told otherwise."""
    if moving_axes:
        angles = Rotation.from_matrix(matrix[:3, :3]).as_euler("XYZ")
        return [*(float(value) for value in matrix[:3, 3]), *(float(a) for a in angles)]
    x, y, z, a, b, c = matrix_to_written(matrix)
    return [x * MM, y * MM, z * MM, radians(c), radians(b), radians(a)]


def from_six(six: list[float], *, moving_axes: bool = False) -> Array:
    """The 4x4 matrix of six numbers."""
    x, y, z, rx, ry, rz = six
    matrix = written_matrix([x / MM, y / MM, z / MM, degrees(rz), degrees(ry), degrees(rx)])
    if moving_axes:
        matrix[:3, :3] = Rotation.from_euler("XYZ", [rx, ry, rz]).as_matrix()
    return matrix
