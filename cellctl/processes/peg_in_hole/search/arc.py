"""Touches along the outer face of a plug, and the circle through them.

Source: section 3.6 of the study of insertion by touch. There the arc is traced in contact; here it
is touched point by point, since motions by touch press along one axis at a time.
"""

from math import ceil, radians
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
_CLEAR_M = 3e-3
_NEAR_M = 0.3e-3
_FREE_M_S = 20e-3
_ARC_RAD = radians(120)
_RESIDUAL_M = 0.1e-3


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
    task = probe.task
    # Where the plug is not known yet a touch may grow as far as half the limit of the insertion.
    far_m_s = touch_speed_m_s(
        task.cell.stiffness_n_m, task.cell.dead_time_s, task.limits.insertion_n / 2
    )
    centre_m = edge_m - np.array([rim_m, 0.0])
    await probe.motions.back_out(_NEAR_M)
    beside_rad: float | None = None
    for angle in _angles():
        outwards = np.array([np.cos(angle), np.sin(angle)])
        known = len(points) >= 3
        unknown_m = 0.0 if known else task.cell.uncertainty_m
        if beside_rad is None:
            over = np.array([*(centre_m + (rim_m + _CLEAR_M) * outwards), -_NEAR_M])
            await probe.motions.move_free(over, UPRIGHT, _FREE_M_S)
        elif not await _went_round(probe, centre_m, rim_m + unknown_m, (beside_rad, angle)):
            # What stands beside the plug is none of it: no touch from there would tell anything.
            break
        beside_rad = angle
        # Along its first edge the plug is known from the slide, across it only as well as the hole
        # was before.
        gap_m = _NEAR_M + unknown_m * abs(np.sin(angle))
        begin_m = centre_m + (rim_m + gap_m) * outwards
        await probe.motions.move_free(np.array([*begin_m, _BELOW_FACE_M]), UPRIGHT, _FREE_M_S)
        touched = await probe.motions.touch(
            np.array([*-outwards, 0.0]),
            2 * gap_m + _CLEAR_M,
            probe.parameters.side_force.value,
            None if known else far_m_s,
        )
        probe.still_in_time(touched.last)
        # Where nothing was met, three of the other touches are enough for a circle.
        if touched.ended is Ended.FORCE:
            probe.trace.note(touched.last, Felt.WALL)
            points.append(touched.last.task_position_tip_m[:2].copy())
            begin_m = points[-1]
        back = np.array([*(begin_m + _CLEAR_M * outwards), _BELOW_FACE_M])
        await probe.motions.move_free(back, UPRIGHT, _FREE_M_S)
        if len(points) >= 3:
            centre_m = circle_through(np.stack(points))[0]
    return points


async def _went_round(
    probe: TouchProbe, centre_m: Array, inside_m: float, angles_rad: tuple[float, float]
) -> bool:
    """From one angle beside the plug to another, never within a radius; False where it was stopped.

    The straight way leads through the plug.
    """
    radius_m, (from_rad, to_rad) = inside_m + _CLEAR_M, angles_rad
    # The middle of each short straight piece is nearer to the plug than its ends.
    step_rad = 2 * np.arccos((inside_m + _CLEAR_M / 2) / radius_m)
    steps = ceil(abs(to_rad - from_rad) / step_rad)
    for at_rad in np.linspace(from_rad, to_rad, steps + 1):
        place_m = centre_m + radius_m * np.array([np.cos(at_rad), np.sin(at_rad)])
        moved = await probe.motions.move_free(
            np.array([*place_m, _BELOW_FACE_M]), UPRIGHT, _FREE_M_S
        )
        if moved.ended is Ended.FORCE:
            return False
    return True


def _angles() -> list[float]:
    """The first three far apart, so that the circle is known early; the others between them."""
    half = _ARC_RAD / 2
    between = np.linspace(-half, half, ARC_TOUCHES)
    first = [0.0, half, -half]
    return first + [float(angle) for angle in between if not np.isclose(angle, first).any()]
