"""Sliding an upright peg over the face of a plug until its rim, or the hole, is reached."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cellctl.cell.contact_motion.motions import Ended
from cellctl.processes.peg_in_hole.search.conditions import LostSupport, either
from cellctl.processes.peg_in_hole.search.probe import UPRIGHT, Felt, TouchProbe

Array = NDArray[np.float64]

SLIDE_M_S = 5e-3
"""Speed of the slide to the first edge of a plug (section 3.6 of the study of insertion by
touch)."""
_INSIDE_M = 0.5e-3
"""How far inside an edge the face is touched again."""
_BEHIND_M = 0.3e-3
"""How far behind a flank the peg is put down again; scratches and burrs are narrower."""


@dataclass(frozen=True, slots=True, eq=False)
class Edge:
    """Where a slide over the face came to its end."""

    point_m: Array
    """Peg centre (2,)."""
    length_m: float
    entered: bool


async def slide_to_edge(probe: TouchProbe, direction: Array, rim_m: float) -> Edge | None:
    """From a contact on the face along a unit vector (2,); None where no edge is in reach.

    A loss of support within the uncertainty of the hole may be the hole, and so may a flank: there
    the peg is pressed, and let go. Behind a flank that lets nothing in the slide goes on.
    """
    begin_m = await _here(probe)
    # A little more than the diameter: an edge is in reach from anywhere on the face.
    end_m = begin_m + 2.2 * rim_m * direction
    while True:
        stop = LostSupport(probe.press_n)
        motion = await probe.slide(end_m[None, :], SLIDE_M_S, either(stop, probe.walled))
        if motion.ended is Ended.TRAVEL:
            return None
        here_m = motion.last.task_position_tip_m[:2]
        # Where the support began to go: until that was believed the peg has gone on.
        lost_m = here_m if stop.begin is None else stop.begin.task_position_tip_m[:2]
        if np.linalg.norm(lost_m) > rim_m / 2:
            probe.trace.note(motion.last, Felt.EDGE)
            return Edge(lost_m, float(np.linalg.norm(lost_m - begin_m)), entered=False)
        if await probe.enters():
            return Edge(lost_m, 0.0, entered=True)
        if stop.begin is None:
            # Slid on from here the peg would only be pressed against the same flank again.
            await probe.touch_down(here_m + _BEHIND_M * direction, UPRIGHT)


async def stand_inside(probe: TouchProbe, edge_m: Array, centre_m: Array) -> Array:
    """Touch down on the face a little inside an edge; the point (2,)."""
    inwards = (centre_m - edge_m) / np.linalg.norm(centre_m - edge_m)
    point_m = np.asarray(edge_m + _INSIDE_M * inwards)
    await probe.touch_down(point_m, UPRIGHT)
    return point_m


async def _here(probe: TouchProbe) -> Array:
    pressed = await probe.motions.press(probe.press_n, 0.05)
    return pressed.last.task_position_tip_m[:2].copy()
