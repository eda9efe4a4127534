"""Which samples of a curve are the feed to the seat, the pushes to the sides, the turns, the pull.

By the motions where the file names them, else by what was felt.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, takewhile

import numpy as np

from cellctl.cell.contact_motion.motions import ContactMotion, ContactSample, Ended
from cellctl.cell.contact_motion.ticks import MotionKind
from cellctl.processes.peg_in_hole.offline.curve import PegCurve
from cellctl.processes.peg_in_hole.verdict.judged_task import JudgedTask
from cellctl.processes.peg_in_hole.verdict.lateral import SIDES, Side, push_force_n

Samples = tuple[ContactSample, ...]


@dataclass(frozen=True, slots=True, eq=False)
class CurveParts:
    """The parts of one curve; a part that is not in it is None or empty."""

    feed: Samples
    """The last one, to the seat or to where the peg stands, as one where the sensor was asked."""
    way_in: Samples
    """In which no force may act with the feed: all that is known of it, back to the chamfers."""
    begun: ContactSample | None
    """Pressed lightly, before the first push."""
    pushes: Mapping[Side, ContactMotion | None]
    before_turns: ContactSample | None
    turned: tuple[Samples, ...]
    """One for each sense in which the part was turned."""
    pulled: Samples


def by_motions(curve: PegCurve, task: JudgedTask) -> CurveParts | None:
    """The parts by the named motions; None for a curve without names or without a feed."""
    if curve.motions is None:
        return None
    motions = [
        (kind, tuple(sample for _, sample in group))
        for (_, kind), group in groupby(
            zip(curve.motions, curve.samples, strict=True), key=lambda pair: pair[0]
        )
    ]
    feeds = [index for index, (kind, _) in enumerate(motions) if kind is MotionKind.FEED]
    if not feeds:
        return None
    feed = _insertion(motions, feeds[-1])
    # Drawing the part out ends what the verdict rests on.
    after = list(
        takewhile(lambda motion: motion[0] is not MotionKind.BACK_OUT, motions[feeds[-1] + 1 :])
    )
    turned = [samples for kind, samples in after if kind is MotionKind.TURN]
    touched = [(samples, _side(samples)) for kind, samples in after if kind is MotionKind.TOUCH]
    pushes: dict[Side, ContactMotion | None] = dict.fromkeys(SIDES)
    for samples, side in reversed(touched):
        if side is not None:
            pushes[side] = _push(samples, side, task)
    pulled = next((samples[-1:] for samples, side in touched if side is None), ())
    before_turns = takewhile(lambda motion: motion[0] is not MotionKind.TURN, after)
    pressed = [samples[-1] for kind, samples in before_turns if kind is MotionKind.PRESS]
    begun, last = (pressed[0], pressed[-1]) if pressed else (None, None)
    # Every second turn goes back.
    return CurveParts(feed, feed, begun, pushes, last, tuple(turned[::2]), pulled)


def _insertion(motions: Sequence[tuple[MotionKind, Samples]], last: int) -> Samples:
    """The last feed, with the one before it where only a question to the sensor lies between."""
    before = last - 1
    while before >= 0 and motions[before][0] is MotionKind.TOUCH:
        before -= 1
    asked = 0 <= before < last - 1 and motions[before][0] is MotionKind.FEED
    return (motions[before][1] if asked else ()) + motions[last][1]


def _side(samples: Samples) -> Side | None:
    """The way of a touch; None for one along the axis."""
    way = samples[-1].task_position_tip_m - samples[0].task_position_tip_m
    axis = int(np.argmax(np.abs(way)))
    return None if axis == 2 else (axis, 1.0 if way[axis] > 0 else -1.0)


def _push(samples: Samples, side: Side, task: JudgedTask) -> ContactMotion:
    axis, sign = side
    # The file has four decimals.
    least_n = push_force_n(task.cell) - 1e-3
    way_m = np.array([sign * float(sample.task_position_tip_m[axis]) for sample in samples])
    against_n = np.array([-sign * float(sample.force_n[axis]) for sample in samples])
    # On the first half of its way a push leaves the opposite wall, and forces of the other sign
    # would look as if it met that one.
    second = way_m - way_m[0] >= (way_m.max() - way_m[0]) / 2.0
    met = bool((against_n[second] > least_n).any())
    return ContactMotion(Ended.FORCE if met else Ended.TRAVEL, samples)
