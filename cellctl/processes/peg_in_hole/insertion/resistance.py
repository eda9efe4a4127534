"""Way on which something has held a peg back that neither its walls nor its seat explain.

A part that stands in a blocked hole and slips in its fingers makes the same curve as one that goes
in, but for the force with which the fingers rub meanwhile: it stays while the arm goes on. Walls
hold a peg back by friction, which shows in side force and moment; contacts of a plug do it from a
depth on that its recipe states; the seat, within the way that its stiffness gives. Source: peg_slip
in section 5.2 of the study of insertion by touch.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.geometry.pose import Array
from cellctl.processes.peg_in_hole.insertion.felt import OUT_OF_BAND_N
from cellctl.processes.peg_in_hole.insertion.jam import jam_ratio
from cellctl.processes.peg_in_hole.plan.task import FitGeometry

ZONE_M = 0.3e-3
"""Contacts may begin so much before their depth by the drawing: the tolerance of the seat."""
_BANDS = 3
"""Parts of the rise at the seat, of which the steepest tells its stiffness: a force that stays lies
in one of them, or on the border of two."""
_LEAST_SAMPLES = 3
"""A feed of fewer samples has no slope to be judged by."""


def held_way_m(
    feed: Sequence[ContactSample], fit: FitGeometry, friction: float, stiffness_n_m: float
) -> float:
    """The way of one feed to the seat, less what its force takes at its steepest rise.

    ``stiffness_n_m``: upper bound of arm and contact along the axis. Only depths between the walls
    count: a chamfer holds a peg back until the arm has given way to the side.
    """
    if len(feed) < _LEAST_SAMPLES:
        return 0.0
    depth_m = np.array([sample.task_position_tip_m[2] for sample in feed])
    left_n = _unexplained_n(feed, depth_m, fit, friction)
    above = (left_n > _most_n(depth_m, fit)) & (depth_m > fit.entry_depth_m)
    way_m = float(np.diff(depth_m)[above[1:]].sum())
    axial_n = np.array([-float(sample.force_n[2]) for sample in feed])
    peak = int(np.argmax(axial_n))
    free = np.flatnonzero(~above[: peak + 1])
    risen_n = float(axial_n[peak] - axial_n[free[-1] if free.size else 0])
    return way_m - risen_n / _steepest_n_m(depth_m, axial_n, stiffness_n_m)


def unrubbed_way_m(
    feed: Sequence[ContactSample], fit: FitGeometry, stiffness_n_m: float
) -> float | None:
    """The way on which the contacts of a part should rub and are not felt to; None without any.

    A part that slips in its fingers with less force than its contacts take stands before them.
    """
    contacts = fit.contacts
    if contacts is None:
        return None
    depth_m = np.array([sample.task_position_tip_m[2] for sample in feed])
    axial_n = np.array([-float(sample.force_n[2]) for sample in feed])
    # Where the tip is: the arm goes on by what it gives way.
    tip_m = depth_m - axial_n / stiffness_n_m
    between = (tip_m > contacts.full_m + ZONE_M) & (tip_m < fit.depth_m - ZONE_M)
    slack = between & (axial_n < contacts.least_n)
    return float(np.diff(depth_m)[slack[1:]].sum())


def _unexplained_n(
    feed: Sequence[ContactSample], depth_m: Array, fit: FitGeometry, friction: float
) -> Array:
    """Force against the feed beyond what contacts at two points of the walls make by friction."""
    force_n = np.array([sample.force_n for sample in feed])
    # A moment that was not recorded explains nothing.
    moment_n_m = np.nan_to_num(np.array([sample.moment_n_m for sample in feed]))
    bore_m = depth_m - fit.hole_chamfer_m - fit.peg_chamfer_m
    walls = jam_ratio(force_n, moment_n_m, bore_m, fit.peg_radius_m, friction)
    return np.asarray(-force_n[:, 2] * (1.0 - np.clip(np.nan_to_num(walls), 0.0, 1.0)))


def _most_n(depth_m: Array, fit: FitGeometry) -> Array:
    """Greatest force at each depth that a good part may meet beside friction at its walls."""
    most_n = np.full(len(depth_m), OUT_OF_BAND_N)
    if fit.contacts is not None:
        most_n[depth_m > fit.contacts.depth_m - ZONE_M] += fit.contacts.most_n
    return most_n


def _steepest_n_m(depth_m: Array, axial_n: Array, stiffness_n_m: float) -> float:
    """The rise to the greatest force, by the steepest of its parts; at most the stiffness."""
    peak = int(np.argmax(axial_n))
    levels_n = np.linspace(0.0, axial_n[peak], _BANDS + 1)
    slopes = [
        _slope(depth_m[: peak + 1], axial_n[: peak + 1], low_n, high_n)
        for low_n, high_n in pairwise(levels_n)
    ]
    steepest = max(slopes)
    return min(steepest, stiffness_n_m) if steepest > 0 else stiffness_n_m


def _slope(depth_m: Array, axial_n: Array, low_n: float, high_n: float) -> float:
    """Between the last sample below ``low_n`` and the first one above ``high_n`` after it."""
    below = np.flatnonzero(axial_n <= low_n)
    begin = int(below[-1]) if below.size else 0
    end = begin + int(np.argmax(axial_n[begin:] >= high_n))
    way_m = float(depth_m[end] - depth_m[begin])
    return float(axial_n[end] - axial_n[begin]) / way_m if way_m > 0 else 0.0
