"""Plugs that a correction was not taught with: does it say of them where they sat?"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cellctl.calibration.checks import LimitCheck
from cellctl.geometry.pose import MM, pose_error
from cellctl.processes.antenna_module.chain.cell_figures import PlugCell
from cellctl.processes.antenna_module.chain.compose import taught_socket_T_plug
from cellctl.processes.antenna_module.chain.requirements import (
    require_one_set,
    require_one_wrist,
    require_wrist,
)
from cellctl.processes.antenna_module.chain.schemes import Scheme, base_T_socket
from cellctl.processes.antenna_module.chain.teaching.taught import PlugCorrection
from cellctl.processes.antenna_module.chain.teaching.teaching import TaughtPlug


@dataclass(frozen=True, slots=True)
class CheckLimits:
    """How far a plug may sit from where the correction has it.

    Three standard deviations of a plug that just passes the teaching, and the play of its mean.
    """

    offset_m: float = 50e-6
    turn_rad: float = float(np.radians(0.1))


def checked_with(
    correction: PlugCorrection,
    plugs: Sequence[TaughtPlug],
    cell: PlugCell,
    scheme: Scheme,
    limits: CheckLimits | None = None,
) -> PlugCorrection:
    """The correction with the verdict on further plugs among its checks.

    Raises ``CalibrationsDoNotBelongTogether``, ``WristConfigurationsDiffer``, ``OutOfTaughtRange``
    or what ``Scheme`` raises for a look that is missing.
    """
    limits = limits or CheckLimits()
    checks = [check for plug in plugs for check in _checks(correction, plug, cell, scheme, limits)]
    return replace(correction, checks=(*correction.checks, *checks))


def _checks(
    correction: PlugCorrection,
    plug: TaughtPlug,
    cell: PlugCell,
    scheme: Scheme,
    limits: CheckLimits,
) -> tuple[LimitCheck, LimitCheck]:
    require_one_set(plug.looks, cell)
    require_wrist(require_one_wrist(plug.looks.all()), correction.wrist)
    slot, _ = correction.slot_for(base_T_socket(plug.looks, cell, scheme).pose)
    # The play of the gauge makes it less certain, not another place.
    exact = np.zeros((6, 6))
    sat = taught_socket_T_plug(plug.looks, plug.base_T_flange, exact, cell, scheme).total.pose
    off_m, turn_rad = pose_error(slot.socket_T_plug.pose, sat)
    offset_mm = float(np.linalg.norm(off_m[:2])) / MM
    turn_deg = abs(float(np.degrees(turn_rad[2])))
    return (
        LimitCheck(f"{plug.name}: offset", offset_mm, limits.offset_m / MM, "mm"),
        LimitCheck(f"{plug.name}: yaw", turn_deg, float(np.degrees(limits.turn_rad)), "°"),
    )
