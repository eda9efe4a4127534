"""Which mistake explains stops of A1 and A2 that do not fit the arm.

As for hand-eye: the same stops are solved as they would be without the usual mistakes; the one with
which every check passes is named. Nothing is mended by itself.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cellctl.calibration.solvers.base_frame.axis_fit import AxisStop
from cellctl.calibration.solvers.base_frame.base_frame import ArmGeometry, calibrate_base_frame
from cellctl.errors import CellError


def explanation(
    a1_stops: Sequence[AxisStop], a2_stops: Sequence[AxisStop], arm: ArmGeometry
) -> str:
    """The mistake without which the stops fit; empty when no single one explains them.

    Where several do, all are named: a base that stands on its head fits the other sign as well.
    """
    first, second = list(a1_stops), list(a2_stops)
    tried = {
        "the stops of A1 stand in a2 and those of A2 in a1": (second, first, arm),
        f"A1 turns the other way: a1_sign = {-arm.a1_sign}": (
            first,
            second,
            replace(arm, a1_sign=-arm.a1_sign),
        ),
        f"A2 turns the other way: a2_sign = {-arm.a2_sign}": (
            first,
            second,
            replace(arm, a2_sign=-arm.a2_sign),
        ),
        "d1_mm and a1_mm are exchanged": (
            first,
            second,
            replace(arm, d1_m=arm.a1_m, a1_m=arm.d1_m),
        ),
        "the order of joints_deg is turned round: A6 stands first": (
            [_reversed(stop) for stop in first],
            [_reversed(stop) for stop in second],
            arm,
        ),
    }
    return ", or ".join(words for words, changed in tried.items() if _passes(*changed))


def _passes(first: Sequence[AxisStop], second: Sequence[AxisStop], arm: ArmGeometry) -> bool:
    try:
        return calibrate_base_frame(first, second, arm).passed
    except CellError:
        return False


def _reversed(stop: AxisStop) -> AxisStop:
    return replace(stop, joints_rad=np.asarray(stop.joints_rad)[::-1])
