"""Drawings that are mirrored against the part that an image shows."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cellctl.errors.vision import DrawingMirrored
from cellctl.geometry.pose import Array
from cellctl.vision.features.hole import Hole
from cellctl.vision.registration.rigid_fit import kabsch, on_a_line

_MIRROR = np.array([-1.0, 1.0, 1.0])
_UPRIGHT = float(np.cos(np.radians(20.0)))
"""A face whose normal is nearer to z than this is drawn from above or from below."""


def mirrored(holes: Sequence[Hole]) -> tuple[Hole, ...]:
    """The drawing with the other sign of x.

    That of y, or a view from the back, gives the same drawing in another position.
    """
    return tuple(
        replace(
            hole,
            position_m=hole.position_m * _MIRROR,
            outward=None if hole.outward is None else hole.outward * _MIRROR,
        )
        for hole in holes
    )


def has_mirror_image(holes: Sequence[Hole]) -> bool:
    """Whether a mirrored drawing is another one: holes on a line lie in one plane with it."""
    return not on_a_line(np.array([hole.position_m for hole in holes]))


def require_seen_face(holes: Sequence[Hole], positions_m: Array) -> None:
    """Raise ``DrawingMirrored`` where z of the drawing points away from the head.

    ``positions_m``, shape (n, 3), are the measured ones in the left camera. Holes in a plane fit
    their mirror image as well as themselves, seen from the back. A drawing that states its
    ``outward_axis`` has been held against it, in any other one z usually points out of the face.
    """
    if holes[0].outward is not None or not has_mirror_image(holes):
        return
    nominal = np.array([hole.position_m for hole in holes])
    across = np.linalg.svd(nominal - nominal.mean(axis=0))[2][2]
    z_axis = kabsch(nominal, positions_m)[0][:, 2]
    if abs(across[2]) > _UPRIGHT and z_axis @ positions_m.mean(axis=0) > 0.0:
        raise DrawingMirrored(
            "the holes fit only with z of the drawing away from the head, into the part. If z "
            "points out of the face that is seen, x or y of all holes has the wrong sign; if it "
            "points into the part, state outward_axis = [0.0, 0.0, -1.0]"
        )
