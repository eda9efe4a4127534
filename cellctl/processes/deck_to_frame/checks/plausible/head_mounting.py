"""A head that its mounting has elsewhere than the stored board transfer measured it."""

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.checks.plausible.view import HeadView
from cellctl.processes.deck_to_frame.record_names import BOARD_TRANSFER_NAME
from cellctl.processes.deck_to_frame.roles import MEASURING

APART_MM, APART_DEG = 100.0, 10.0
"""Distance and angle beyond which a mounting is told: bases of arms and heads on flanges are less
off their drawings."""
_AGREES = 0.25
"""Share of these within which a corrected mounting has to agree: so close it comes only when it was
meant. Otherwise a turn by 9° the other way would pass for the correction of one by 11°."""


def is_apart(modelled: RigidTransform, calibrated: RigidTransform) -> bool:
    """Whether two places of one camera are farther from each other than drawings explain."""
    return _apart(modelled, calibrated) > 1.0


def mounted_elsewhere(
    view: HeadView, modelled: RigidTransform, calibrated: RigidTransform
) -> ConfigIssue:
    """``modelled`` follows from mounting, taught pose and model of the cell, ``calibrated`` from
    the board transfer at the same taught pose."""
    between = modelled.inv() * calibrated
    away_mm = float(np.linalg.norm(between.translation)) / MM
    turned_deg = float(np.degrees(between.rotation.magnitude()))
    found = (
        f"{away_mm:.0f} mm and {turned_deg:.0f} deg away from where the stored "
        f"{BOARD_TRANSFER_NAME} has this camera"
    )
    mounting = view.mounting()
    meant = [
        other
        for other in _with_other_signs(view.mounted_mm_deg())
        if (camera := view.camera(view.carrier, MEASURING, other)) is not None
        and _apart(camera, calibrated) < _AGREES
    ]
    if len(meant) == 1:
        allowed = f"did you mean {meant[0]}? There the transfer has this camera; so it is {found}"
        return ConfigIssue(mounting.key, mounting.value, allowed)
    # The taught pose is the one of the transfer, so that it is not among them.
    against = (view.by_model(), view.kinematics(view.carrier), view.by_transfer())
    return ConfigIssue(mounting.key, mounting.value, found, against=against)


def _apart(one: RigidTransform, other: RigidTransform) -> float:
    """The greater of distance and turn, as shares of what drawings explain."""
    between = one.inv() * other
    away_m = float(np.linalg.norm(between.translation))
    turned_deg = float(np.degrees(between.rotation.magnitude()))
    return max(away_m / (APART_MM * MM), turned_deg / APART_DEG)


def _with_other_signs(written: Sequence[float]) -> Iterator[list[float]]:
    """The pose with the signs of one or two of its figures turned."""
    for count in (1, 2):
        for turned in combinations((index for index, one in enumerate(written) if one), count):
            yield [-one if index in turned else one for index, one in enumerate(written)]
