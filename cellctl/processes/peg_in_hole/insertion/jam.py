"""How near a peg is to a jam: what side force and moment are of what two points of contact carry.

With contacts at two points, both sliding, ``M / (r F_z) + μ (1 + λ) F_x / F_z`` is ``λ`` or ``−λ``
and ``|F_x / F_z|`` at most ``1 / μ``, where ``λ = l / (2 r μ)`` and l is the depth without the
chamfers. Anything within moves in; on the border it slides with friction alone, and nothing that
pushes harder helps. Sources: D. E. Whitney, Journal of Dynamic Systems, Measurement, and Control
104 (1982) 65; section 5.1 of the study of insertion by touch.
"""

import numpy as np

from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.geometry.pose import Array
from cellctl.processes.peg_in_hole.plan.task import FitGeometry

LEAST_AXIAL_N = 2.0
"""With less than this along the axis the ratios are mostly noise."""
LEAST_DEPTH_M = 0.3e-3
"""With less depth in the bore the two points of contact are too near to each other to be told
apart, and the ratio would divide by nearly nothing."""


def jam_ratio(
    force_n: Array, moment_n_m: Array, bore_m: Array, radius_m: float, friction: float
) -> Array:
    """1 on the border of a jam, less within, NaN where it cannot be told; shape (n,).

    ``force_n`` and ``moment_n_m`` (n, 3) are those of the hole on the peg about its tip, z into the
    hole; ``bore_m`` (n,) is the depth of the tip in the bore, without the chamfers.
    """
    axial_n = -force_n[:, 2]
    told = (axial_n > LEAST_AXIAL_N) & (bore_m > LEAST_DEPTH_M)
    axial_n, depth_m = np.where(told, axial_n, np.nan), np.where(told, bore_m, np.nan)
    two_points = depth_m / (2 * radius_m * friction)
    # All that acts on the peg is in balance, so that what the hole makes says what the arm pushes
    # with: both have the same ratios.
    aside = -force_n[:, :2] / axial_n[:, None]
    # The moment about y belongs to the force along x, and that about x, with the other sign, to y.
    tilting = np.stack([-moment_n_m[:, 1], moment_n_m[:, 0]], axis=1) / (
        radius_m * axial_n[:, None]
    )
    both = tilting + friction * (1 + two_points)[:, None] * aside
    by_moment = np.hypot(*both.T) / two_points
    return np.asarray(np.maximum(friction * np.hypot(*aside.T), by_moment))


def rubbing_n(sample: ContactSample, fit: FitGeometry, friction: float) -> float:
    """Force against the feed that two sliding points of the walls make, by side and moment."""
    bore_m = sample.task_position_tip_m[2] - fit.hole_chamfer_m - fit.peg_chamfer_m
    # A moment that was not recorded explains nothing.
    moment_n_m = np.nan_to_num(sample.moment_n_m)[None, :]
    force_n = sample.force_n[None, :]
    (ratio,) = jam_ratio(force_n, moment_n_m, np.array([bore_m]), fit.peg_radius_m, friction)
    share = 0.0 if np.isnan(ratio) else min(float(ratio), 1.0)
    return share * max(-float(sample.force_n[2]), 0.0)
