"""The parts of a curve whose file does not name its motions, by what was felt.

The feed ends where the axial force is greatest at the greatest depth. After that a push to a side
is a way along it with a force against it.
"""

from dataclasses import replace

import numpy as np

from cellctl.cell.contact_motion.motion_rules.ends import SOFTEST
from cellctl.cell.contact_motion.motions import ContactMotion, ContactSample, Ended
from cellctl.geometry.pose import Array
from cellctl.processes.peg_in_hole.offline.curve import PegCurve
from cellctl.processes.peg_in_hole.offline.split import CurveParts, Samples
from cellctl.processes.peg_in_hole.verdict.answer import MARGIN_M
from cellctl.processes.peg_in_hole.verdict.judged_task import JudgedTask
from cellctl.processes.peg_in_hole.verdict.lateral import SIDES, Side, push_force_n

_MEAN_S = 10e-3
"""Time over which a force is averaged: ``force_sigma_n`` is that of ten samples at 1 kHz."""
_DEEPEST_M = 0.1e-3
"""How far above the greatest depth the force of the seat is looked for."""
_FEED_WAY_M = 3e-3
"""Length of the end of the feed by which the rise at the seat is judged."""
_MOVED = 0.5
"""Least movement of an arm that was pushed, as a share of what it yields under the push."""
_NEARLY = 0.9
"""Share of a push that counts as the whole: a mean over 10 ms lags behind a force that rises to its
end."""
_GROWS = _MOVED / SOFTEST / 4.0
"""Share of a push by which it grows at least on the second half of that movement: half of the half
of what arm and contact make on it, as soft as they may be."""
_LIFTED_M = 1e-3
"""Higher than this over where a peg stands without force, it is being drawn out."""


def by_force(curve: PegCurve, task: JudgedTask) -> CurveParts:
    """The parts; a side that was not pushed, or a turn that was not made, is left out."""
    samples = averaged(curve)
    depth_m = np.array([sample.task_position_tip_m[2] for sample in samples])
    axial_n = np.array([-sample.force_n[2] for sample in samples])
    deep = np.flatnonzero(depth_m > depth_m.max() - _DEEPEST_M)
    end = int(deep[np.argmax(axial_n[deep])])
    before = np.flatnonzero(depth_m[:end] < depth_m[end] - _FEED_WAY_M)
    begin = int(before[-1]) + 1 if before.size else 0
    # Without the force of the seat the arm comes back by what it has yielded.
    stands_m = depth_m[end] - axial_n[end] / task.cell.stiffness_n_m
    lifted = np.flatnonzero(depth_m[end:] < stands_m - _LIFTED_M)
    after = samples[end + 1 : end + int(lifted[0]) if lifted.size else len(samples)]
    contacts = {side: _first_contact(after, side, task) for side in SIDES}
    first = min((index for index in contacts.values() if index is not None), default=None)
    pushes = {side: _pushed(after, side, index, task) for side, index in contacts.items()}
    last = max((index for index in contacts.values() if index is not None), default=0)
    rest = after[last + 1 :]
    return CurveParts(
        feed=samples[begin : end + 1],
        way_in=_way_in(samples[: end + 1], task),
        begun=_before_pushes(after, first),
        pushes=pushes,
        before_turns=rest[0] if rest else None,
        turned=_turned(rest),
        pulled=rest,
    )


def _way_in(until_seat: Samples, task: JudgedTask) -> Samples:
    """What went deeper between the walls than all before it, since the peg last was out of them.

    A peg that is drawn back meanwhile is held by its walls, and that is no force with the feed.
    """
    depth_m = np.array([sample.task_position_tip_m[2] for sample in until_seat])
    outside = np.flatnonzero(depth_m < task.fit.entry_depth_m)
    begin = int(outside[-1]) + 1 if outside.size else 0
    deepest_m = np.maximum.accumulate(depth_m[begin:])
    deeper = np.flatnonzero(np.diff(deepest_m, prepend=-np.inf) > 0.0)
    return tuple(until_seat[begin + int(index)] for index in deeper)


def averaged(curve: PegCurve) -> Samples:
    """Means over 10 ms of what was sampled faster."""
    size = round(_MEAN_S / curve.interval_s)
    if size < 2:
        return curve.samples
    samples = curve.samples
    return tuple(
        _mean(samples[begin : begin + size]) for begin in range(0, len(samples) - size + 1, size)
    )


def _mean(block: Samples) -> ContactSample:
    return replace(
        block[-1],
        time_s=float(np.mean([one.time_s for one in block])),
        task_position_tip_m=np.mean([one.task_position_tip_m for one in block], axis=0),
        force_n=np.mean([one.force_n for one in block], axis=0),
        moment_n_m=np.mean([one.moment_n_m for one in block], axis=0),
    )


def _first_contact(after: Samples, side: Side, task: JudgedTask) -> int | None:
    """Where a push to a side meets its force, after a way along that side: as soon as it does,
    since a run ends its push there, and what is pushed on yields without telling more.

    A force that falls on that way is what the push to the other side has left, by a file whose
    forces have the other sign.
    """
    if not after:
        return None
    axis, sign = side
    push_n = push_force_n(task.cell)
    way_m = _along(after, side)
    against_n = np.array([-sign * float(sample.force_n[axis]) for sample in after])
    moved_m = way_m - np.minimum.accumulate(way_m)
    pushed = against_n > _NEARLY * push_n
    met = np.flatnonzero(pushed & (moved_m > _MOVED * push_n / task.cell.stiffness_n_m))
    grows_n = _GROWS * push_n
    begin = next((int(at) for at in met if _grown_n(way_m, against_n, int(at)) > grows_n), None)
    if begin is None:
        return None
    let_go = np.flatnonzero(~pushed[begin:])
    end = begin + int(let_go[0]) if let_go.size else len(after)
    whole = np.flatnonzero(against_n[begin:end] >= push_n)
    return begin + int(whole[0] if whole.size else np.argmax(against_n[begin:end]))


def _grown_n(way_m: Array, against_n: Array, at: int) -> float:
    """By how much the force has grown since the first half of the way that leads to a sample."""
    turned = int(np.argmin(way_m[: at + 1]))
    since_m = way_m[turned : at + 1] - way_m[turned]
    return float(against_n[at] - against_n[turned : at + 1][since_m <= since_m[-1] / 2.0].max())


def _pushed(
    after: Samples, side: Side, contact: int | None, task: JudgedTask
) -> ContactMotion | None:
    if not after:
        return None
    way_m = _along(after, side)
    if contact is not None:
        # From where the way along that side began: its rise tells how arm and contact yield.
        begin = int(np.argmin(way_m[: contact + 1]))
        return ContactMotion(Ended.FORCE, tuple(after[begin : contact + 1]))
    # As far as a push of the process goes that meets nothing.
    yields_m = push_force_n(task.cell) / task.cell.stiffness_n_m
    whole_m = 2 * task.fit.clearance_m + yields_m + MARGIN_M
    moved_m = way_m - np.minimum.accumulate(way_m)
    farthest = int(np.argmax(moved_m))
    return ContactMotion(Ended.TRAVEL, (after[farthest],)) if moved_m[farthest] > whole_m else None


def _along(after: Samples, side: Side) -> Array:
    axis, sign = side
    return np.array([sign * float(sample.task_position_tip_m[axis]) for sample in after])


def _before_pushes(after: Samples, first: int | None) -> ContactSample | None:
    """Pressed, with hardly a force to the side: the one of these that comes last."""
    if not after:
        return None
    before = after[: first + 1] if first is not None else after[:1]
    side_n = np.array([float(np.hypot(*sample.force_n[:2])) for sample in before])
    calm = np.flatnonzero(side_n <= side_n.min() + 0.25 * np.ptp(side_n))
    return before[int(calm[-1])]


def _turned(rest: Samples) -> tuple[Samples, ...]:
    """Both senses of the moment about the axis; none where no moment is known."""
    if not rest or any(np.isnan(sample.moment_n_m[2]) for sample in rest):
        return ()
    return (rest, rest)
