"""Readings of a board transfer that cannot be of the heads that they are written for."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.checks import LimitCheck
from cellctl.calibration.solvers.transfer.board_transfer import BoardPlacement
from cellctl.errors.calibration import BoardPoseInvalid
from cellctl.geometry.pose import MM, pose_error
from cellctl.geometry.uncertain import UncertainPose

_SAME_M = 1e-6
"""Two readings that differ by less are one that was copied: the noise of any head is greater."""


def require_unmistaken(
    file: str, before_head_1: Sequence[BoardPlacement], before_head_2: Sequence[BoardPlacement]
) -> None:
    """Raise ``BoardPoseInvalid`` that names an exchanged or a copied table.

    Which of two small heads is I nothing in the file can tell: the cell file has their arms.
    """
    for head, placements in (("head_1", before_head_1), ("head_2", before_head_2)):
        for number, placement in enumerate(placements, start=1):
            large_m = _distance_m(placement.c_T_board.head_T_board)
            small_m = _distance_m(placement.head_T_board.head_T_board)
            if small_m > large_m:
                raise BoardPoseInvalid(
                    f"{file}: {head}, entry {number}: 'large_field' and 'head' are exchanged? The "
                    f"board is {small_m / MM:.0f} mm from the small head and {large_m / MM:.0f} mm "
                    "from the large-field head"
                )
    for first in before_head_1:
        for second in before_head_2:
            if _same(first.head_T_board.head_T_board, second.head_T_board.head_T_board):
                raise BoardPoseInvalid(
                    f"{file}: head_1 and head_2 have the same readings of the board: one was copied"
                )


def inverted_base(
    places: Mapping[str, RigidTransform], if_inverted: Mapping[str, RigidTransform]
) -> LimitCheck | None:
    """A failed check where only the inverse of c_T_base has the heads before the arm; else None.

    ``places`` is base_T_head, ``if_inverted`` the same for a c_T_base that was written as base_T_c.
    The robot works in front of its base and above the plane on which it stands, and so do the heads
    that look at its part. An arm may be set up to work behind: the cell file tells.
    """
    written, inverse = (_least_before_m(one.values()) for one in (places, if_inverted))
    if written >= 0.0 or inverse < 0.0 or _least_before_m(places.values(), every=False) >= 0.0:
        return None
    return LimitCheck(
        "least x and z of the heads in the base (c_T_base may be its inverse, base_T_c: that has "
        "both before the arm)",
        written / MM,
        0.0,
        "mm",
        side="min",
    )


def _least_before_m(places: Iterable[RigidTransform], *, every: bool = True) -> float:
    """How far the worst of the places is in front of the base and above it; with ``every`` off, how
    far the best of them is."""
    each = [float(min(place.translation[[0, 2]])) for place in places]
    return min(each) if every else max(each)


def _distance_m(pose: UncertainPose) -> float:
    return float(np.linalg.norm(pose.pose.translation))


def _same(one: UncertainPose, other: UncertainPose) -> bool:
    shift, turn = pose_error(one.pose, other.pose)
    return float(np.linalg.norm(shift)) < _SAME_M and float(np.linalg.norm(turn)) < _SAME_M
