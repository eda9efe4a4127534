"""What a recorded curve says of each item of the verdict, as the run itself would have found it."""

from dataclasses import replace

import numpy as np

from cellctl.cell.contact_motion.motions import Ended
from cellctl.force.contact.recorded_units import (
    impossible_depths,
    impossible_forces,
    impossible_speed,
    unread_component,
)
from cellctl.geometry.pose import Array
from cellctl.processes.peg_in_hole.faults import PegCurveInvalid
from cellctl.processes.peg_in_hole.insertion.felt import (
    Standing,
    greatest_axial_n,
    seat_slope_n_m,
    unloaded_depth_m,
)
from cellctl.processes.peg_in_hole.insertion.resistance import held_way_m, unrubbed_way_m
from cellctl.processes.peg_in_hole.insertion.with_feed import LEAST_SIGN_N, with_feed_n
from cellctl.processes.peg_in_hole.insertion.zero_jump import dropped_n
from cellctl.processes.peg_in_hole.offline.columns import DEPTH, FORCES, TIME
from cellctl.processes.peg_in_hole.offline.curve import PegCurve
from cellctl.processes.peg_in_hole.offline.felt_parts import by_force
from cellctl.processes.peg_in_hole.offline.split import CurveParts, by_motions
from cellctl.processes.peg_in_hole.offline.task_file import TaskOfCurve
from cellctl.processes.peg_in_hole.offline.zero import not_tared
from cellctl.processes.peg_in_hole.verdict.evidence import InsertionEvidence, LateralCapture
from cellctl.processes.peg_in_hole.verdict.holding import MET_N_M
from cellctl.processes.peg_in_hole.verdict.lateral import SIDES, capture_of


def evidence_of(curve: PegCurve, task: TaskOfCurve) -> InsertionEvidence:
    """Raises ``PegCurveInvalid`` for signs or units that contradict what was done."""
    _require_possible_units(curve, task)
    if (why := not_tared(curve)) is not None:
        raise PegCurveInvalid(why)
    parts = _split(curve, task)
    _require_signs(curve, parts, task)
    end = Standing.of(parts.feed[-1])
    fit = task.fit
    return InsertionEvidence(
        depth_m=unloaded_depth_m(end, task.cell.stiffness_n_m, task.face_yields_m),
        seat_force_n=end.axial_n,
        seat_slope_n_m=seat_slope_n_m(parts.feed),
        held_way_m=held_way_m(parts.feed, fit, task.cell.friction, task.cell.stiffness_n_m),
        unrubbed_way_m=unrubbed_way_m(parts.feed, fit, task.cell.stiffness_n_m),
        with_feed_n=with_feed_n(parts.way_in, task.cell),
        dropped_n=dropped_n(parts.feed, task),
        capture=_capture(parts, task),
        greatest_force_n=max(greatest_axial_n(curve.samples), task.greatest_n),
        grip_force_n=task.grip_n,
        retouch_error_m=None,
        keyed_directions=None if fit.keys is None else _turns_that_resist(parts),
        held_pull_n=None if task.seat.pull_n is None else _held_pull_n(parts),
    )


def _capture(parts: CurveParts, task: TaskOfCurve) -> LateralCapture | None:
    if parts.begun is None or not any(parts.pushes.values()):
        return None
    return capture_of(parts.begun, parts.pushes, task)


def _turns_that_resist(parts: CurveParts) -> int | None:
    """How many of the two turns met a resistance; None where it was not turned, or its moment was
    not recorded."""
    if parts.before_turns is None or len(parts.turned) < 2:
        return None
    free_n_m = float(parts.before_turns.moment_n_m[2])
    signs = set()
    for samples in parts.turned:
        turned_n_m = np.array([float(sample.moment_n_m[2]) for sample in samples]) - free_n_m
        signs |= set(np.sign(turned_n_m[np.abs(turned_n_m) > MET_N_M]).tolist())
    return None if np.isnan(free_n_m) else len(signs)


def _held_pull_n(parts: CurveParts) -> float | None:
    if not parts.pulled:
        return None
    return max(float(sample.force_n[2]) for sample in parts.pulled)


def _require_possible_units(curve: PegCurve, task: TaskOfCurve) -> None:
    depth_m = np.array([sample.task_position_tip_m[2] for sample in curve.samples])
    deepest_m, highest_m = float(depth_m.max()), float(depth_m.min())
    hole_m = task.fit.depth_m
    time_s = np.array([sample.time_s for sample in curve.samples])
    force_n = np.array([sample.force_n for sample in curve.samples])
    forces = [curve.columns.get(name, name) for name in FORCES]
    for why in (
        impossible_depths(depth_m, hole_m, curve.columns.get(DEPTH, DEPTH)),
        impossible_speed(time_s, depth_m, curve.columns.get(TIME, TIME)),
        impossible_forces(force_n, task.seat.most_n, forces),
        unread_component(force_n, forces),
    ):
        if why is not None:
            raise PegCurveInvalid(why)
    if (
        deepest_m < 0.1 * hole_m
        and highest_m < -0.5 * hole_m
        and _pressed_at_lowest(curve, depth_m)
    ):
        raise PegCurveInvalid(
            "depth falls towards the seat: a column that counts out of the hole is a height"
        )


def _pressed_at_lowest(curve: PegCurve, depth_m: Array) -> bool:
    axial_n = np.array([abs(float(sample.force_n[2])) for sample in curve.samples])
    low = depth_m < depth_m.min() + 0.1 * np.ptp(depth_m)
    return bool(axial_n[low].max() > LEAST_SIGN_N)


def _require_signs(curve: PegCurve, parts: CurveParts, task: TaskOfCurve) -> None:
    """The hole pushes a peg back that is fed, and a wall one that is pushed against it."""
    axial_n = np.array([-float(sample.force_n[2]) for sample in parts.feed])
    if -axial_n.min() > max(LEAST_SIGN_N, axial_n.max()):
        raise PegCurveInvalid(
            f"fz is {-axial_n.min():.3g} N into the hole where the peg is fed: those are forces on "
            "the hole (force_on), an axis out of it (height), or a sensor that has lost its zero"
        )
    other = _split(_sides_turned_round(curve), task)
    for axis, name in ((0, "fx"), (1, "fy")):
        if not _met(parts, axis) and _met(other, axis) == 2:
            raise PegCurveInvalid(
                f"{name} acts with the way of the pushes, not against it: another sign than fz has"
            )


def _split(curve: PegCurve, task: TaskOfCurve) -> CurveParts:
    return by_motions(curve, task) or by_force(curve, task)


def _met(parts: CurveParts, axis: int) -> int:
    pushes = [parts.pushes[side] for side in SIDES if side[0] == axis]
    return sum(push is not None and push.ended is Ended.FORCE for push in pushes)


def _sides_turned_round(curve: PegCurve) -> PegCurve:
    turn = np.array([-1.0, -1.0, 1.0])
    samples = tuple(replace(one, force_n=turn * one.force_n) for one in curve.samples)
    return PegCurve(samples, curve.motions, curve.columns)
