"""Touches along the outer face of a plug, and the circle through them.

Source: section 3.6 of the study of insertion by touch. There the arc is traced in contact; here it
is touched point by point, since motions by touch press along one axis at a time.
"""

from math import radians
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from cellctl.cell.contact_motion.motions import Ended
from cellctl.processes.peg_in_hole.plan.choice import ARC_TOUCHES, SearchName
from cellctl.processes.peg_in_hole.plan.parameters import touch_speed_m_s
from cellctl.processes.peg_in_hole.search.circles import circle_through
from cellctl.processes.peg_in_hole.search.edges import slide_to_edge
from cellctl.processes.peg_in_hole.search.probe import UPRIGHT, Felt, TouchProbe
from cellctl.processes.peg_in_hole.search.strategy import SearchStrategy

Array = NDArray[np.float64]

_BELOW_FACE_M = 2e-3
"""Depth below the face at which the side of the plug is touched (section 3.6)."""
_CLEAR_M = 3e-3
"""Distance that is kept from the plug between two touches, and by which a touch goes beyond the
place where the plug is expected."""
_NEAR_M = 0.3e-3
"""Height over the face at which the tip goes from touch to touch."""
_BESIDE_M = 1e-3
"""How far beside the plug the tip goes down: on a stiff arm the slide tells its edge to 0.4 mm."""
_FREE_M_S = 20e-3
"""Greatest speed through free air; the motion itself goes slower where it might meet something."""
_ARC_RAD, _RESIDUAL_M = radians(120), 0.1e-3
"""Length of the arc that is touched, and largest residual of the circle through it (section
3.6)."""


class ArcSearch(SearchStrategy):
    """Search for tight plugs with an outer face, and where the bore may not be touched."""

    name: ClassVar[SearchName] = SearchName.ARC

    async def find(self, probe: TouchProbe) -> bool:
        """First edge by sliding, then touches from the side over 120 degrees."""
        rim_m = probe.task.fit.rim_m or 0.0
        await probe.touch_down(np.zeros(2), UPRIGHT)
        edge = await slide_to_edge(probe, np.array([1.0, 0.0]), rim_m)
        if edge is None:
            return False
        if edge.entered:
            return True
        points = await _touch_arc(probe, edge.point_m, rim_m)
        if len(points) < 3:
            return False
        centre_m, _, residual_m = circle_through(np.stack(points))
        return residual_m < _RESIDUAL_M and await probe.look_round(centre_m)


async def _touch_arc(probe: TouchProbe, edge_m: Array, rim_m: float) -> list[Array]:
    """Peg centres (2,) at the side of the plug."""
    points: list[Array] = []
    meets_m_s = _meets_m_s(probe)
    centre_m = edge_m - np.array([rim_m, 0.0])
    await probe.motions.back_out(_NEAR_M)
    for angle in _angles():
        outwards = np.array([np.cos(angle), np.sin(angle)])
        known = len(points) >= 3
        # Along its first edge the plug is known from the slide, across it only as well as the hole
        # was before.
        unknown_m = 0.0 if known else probe.task.cell.uncertainty_m * abs(np.sin(angle))
        gap_m = _BESIDE_M + unknown_m
        begin_m = centre_m + (rim_m + gap_m) * outwards
        await probe.motions.move_free(np.array([*begin_m, -_NEAR_M]), UPRIGHT, _FREE_M_S)
        beside = np.array([*begin_m, _BELOW_FACE_M])
        if (await probe.motions.move_free(beside, UPRIGHT, meets_m_s)).ended is Ended.FORCE:
            # What stands beside the plug is none of it: no touch from there would tell anything.
            break
        touched = await probe.motions.touch(
            np.array([*-outwards, 0.0]),
            2 * gap_m + _CLEAR_M,
            probe.parameters.side_force.value,
            None if known else meets_m_s,
        )
        probe.still_in_time(touched.last)
        # Where nothing was met, three of the other touches are enough for a circle.
        if touched.ended is Ended.FORCE:
            probe.trace.note(touched.last, Felt.WALL)
            points.append(touched.last.task_position_tip_m[:2].copy())
            begin_m = points[-1]
        clear_m = begin_m + _CLEAR_M * outwards
        # Over the face to the next one: the straight way below it leads through the plug.
        for depth_m in (_BELOW_FACE_M, -_NEAR_M):
            await probe.motions.move_free(np.array([*clear_m, depth_m]), UPRIGHT, _FREE_M_S)
        if len(points) >= 3:
            centre_m = circle_through(np.stack(points))[0]
    return points


def _meets_m_s(probe: TouchProbe) -> float:
    """Speed of a motion beside the plug, where it may meet what nobody knows of.

    The force grows no farther than a touch of the face may, and the side force is there already.
    """
    cell, limits = probe.task.cell, probe.task.limits
    grows_n = max(2 * limits.search_n - probe.parameters.side_force.value, limits.search_n / 2)
    return touch_speed_m_s(cell.stiffness_n_m, cell.dead_time_s, grows_n)


def _angles() -> list[float]:
    """The first three far apart, so that the circle is known early; the others between them."""
    half = _ARC_RAD / 2
    between = np.linspace(-half, half, ARC_TOUCHES)
    first = [0.0, half, -half]
    return first + [float(angle) for angle in between if not np.isclose(angle, first).any()]
