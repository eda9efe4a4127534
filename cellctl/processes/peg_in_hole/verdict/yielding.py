"""How far arm and contact yield sideways under a push, from the push itself.

The stiffness that a cell states is that along the axis of the hole, and arms are often softer
across it: by the stated one alone a good part would show a play that is none. So the yielding is
what the push itself shows, within bounds: a peg that rocks in a hole that is too wide is soft, too.
"""

from collections.abc import Sequence

import numpy as np

from cellctl.cell.contact_motion.motion_rules.ends import SOFTEST
from cellctl.cell.contact_motion.motions import ContactSample

_FROM_SHARE = 0.4
"""Share of the greatest force from which its rise counts: by then the peg leans on its wall."""
_LEAST_SAMPLES = 4
"""With fewer samples a slope is chance, and the stated stiffness is taken."""


def yielded_m(
    samples: Sequence[ContactSample], axis: int, sign: float, push_n: float, stated_n_m: float
) -> float:
    """By how much arm and contact yield under ``push_n`` along an axis, m.

    ``samples`` of a push that something has met; ``stated_n_m`` is the stiffness along the hole.
    What is softer than that by more than ``SOFTEST`` shows as play.
    """
    stated = 1.0 / stated_n_m
    against_n = np.array([-sign * sample.force_n[axis] for sample in samples])
    way_m = np.array([sign * sample.task_position_tip_m[axis] for sample in samples])
    end = int(against_n.argmax()) + 1
    below = np.flatnonzero(against_n[:end] < _FROM_SHARE * against_n[end - 1])
    begin = int(below[-1]) + 1 if below.size else 0
    if end - begin < _LEAST_SAMPLES or np.ptp(against_n[begin:end]) == 0.0:
        return push_n * stated
    # Over the force, whose steps are far above its noise; the way of a stiff arm is not.
    compliance = float(np.polyfit(against_n[begin:end], way_m[begin:end], 1)[0])
    return push_n * float(np.clip(compliance, stated, SOFTEST * stated))
