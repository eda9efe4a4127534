"""The normal of the plane in which the rims of a part lie, needed before the rims are fitted.

Drawings differ: z may point out of the face or into the part, and the face may lie askew in the
part's frame. Where the drawing leaves several normals open, each is tried, and the one in which the
rims show most of their edges is taken.
"""

from collections.abc import Sequence

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.features.hole import Hole
from cellctl.vision.holes.correspondence import Expectation
from cellctl.vision.registration.rigid_fit import kabsch, on_a_line

_SAME_AXIS = float(np.cos(np.radians(1.0)))
"""Axes nearer to each other than 1° count as one: the fit of a rim needs its plane to a degree."""


def possible_normals(
    holes: Sequence[Hole], positions_m: Array, expectation: Expectation | None
) -> list[Array]:
    """Unit normals of the rims' planes that the drawing allows, likeliest first.

    ``positions_m`` (n, 3) are where the holes are, in the left camera; the normals point away from
    it. Empty when nothing says how the part is turned: fewer than three holes, or all on a line,
    and no expected pose.
    """
    nominal = np.array([hole.position_m for hole in holes])
    if not on_a_line(nominal):
        rotation, _ = kabsch(nominal, positions_m)
    elif expectation is not None:
        rotation = expectation.camera_T_part.rotation.as_matrix()
    else:
        return []
    middle = positions_m.mean(axis=0)
    normals = [rotation @ axis for axis in _axes(holes, nominal)]
    return [normal * np.sign(normal @ middle) for normal in normals]


def _axes(holes: Sequence[Hole], nominal: Array) -> list[Array]:
    """Axes of the holes in the part's frame; the sign does not matter."""
    stated = holes[0].outward
    if stated is not None:
        return [stated]
    axes = [np.array([0.0, 0.0, 1.0])]
    if not on_a_line(nominal):
        across = np.linalg.svd(nominal - nominal.mean(axis=0))[2][2]
        if abs(across[2]) < _SAME_AXIS:
            axes.append(across)
    return axes
