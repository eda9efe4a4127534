"""Where a first contact lies: end face, side, edge, or already between the walls.

Forces tell a direction first, then light touches along and against it. Forces alone never say that
a peg is aligned: pressed hard enough, friction resists every light touch. Source: section 2 (S3) of
the study of insertion by touch, which corrects the printed test of the patent.
"""

from dataclasses import dataclass
from enum import StrEnum
from math import atan, radians, tan

import numpy as np
from numpy.typing import NDArray

from cellctl.cell.contact_motion.motions import ContactMotions, ContactSample, Ended, never
from cellctl.processes.peg_in_hole.plan.task import CellFigures, SearchTask

Array = NDArray[np.float64]

LIGHT_N = 2.5
"""Pressed with while touching to the sides: friction resists with less than a touch is met at."""
_LEAST_THRESHOLD_N = 1.0
"""A light touch needs at least this force beyond friction, however quiet the sensor is."""
_FACE_MARGIN_RAD = radians(8)
"""Added to the angle of friction: a force nearer to the axis than that comes from an end face."""
_SIDE_RATIO = 1.5
"""Side force over axial force above which a contact is a side; below it an edge is met."""
_TRAVEL_M = 0.2e-3
"""Way of a light touch beyond what arm, contact and clearance account for."""
_SETTLE_S = 0.3
"""Length of the light press, in which the arm comes to rest before the contact is judged."""


class ContactClass(StrEnum):
    """What the peg has met."""

    END_FACE = "end face"
    SIDE = "side"
    EDGE = "edge"
    ALIGNED = "aligned"
    """Walls all round, and deep enough to be between them."""
    STUCK = "stuck"
    """Resists all round without being deep: friction."""
    WRONG_FEATURE = "wrong feature"
    """Walls at two opposite sides only: a slot, or a gap between parts."""


@dataclass(frozen=True, slots=True, eq=False)
class ClassifiedContact:
    """A contact, and what it is."""

    sample: ContactSample
    """Under the light press, before any touch to the side."""
    found: ContactClass


def light_threshold_n(cell: CellFigures, press_n: float) -> float:
    """A light touch is met above this: friction, and what noise may look like."""
    return cell.friction * press_n + max(3 * cell.force_sigma_n, _LEAST_THRESHOLD_N)


def class_by_force(force_n: Array, cell: CellFigures) -> ContactClass:
    """From the direction of the contact force (3,) alone: end face, edge or side."""
    across_n, along_n = float(np.hypot(force_n[0], force_n[1])), abs(float(force_n[2]))
    if across_n < tan(atan(cell.friction) + _FACE_MARGIN_RAD) * along_n:
        return ContactClass.END_FACE
    return ContactClass.SIDE if across_n > _SIDE_RATIO * along_n else ContactClass.EDGE


def class_by_touches(
    resisted: tuple[bool, bool, bool, bool],
    depth_m: float,
    entry_depth_m: float,
    felt: ContactClass,
) -> ContactClass:
    """From light touches along +x, -x, +y, -y, and the class by force where they leave it open."""
    if all(resisted):
        return ContactClass.ALIGNED if depth_m > entry_depth_m else ContactClass.STUCK
    if not any(resisted):
        return ContactClass.END_FACE
    if resisted in ((True, True, False, False), (False, False, True, True)):
        return ContactClass.WRONG_FEATURE
    return ContactClass.SIDE if felt is ContactClass.END_FACE else felt


async def classify_contact(
    motions: ContactMotions, task: SearchTask, speed_m_s: float, press_n: float = LIGHT_N
) -> ClassifiedContact:
    """Press lightly; where the direction of the force leaves it open, touch to all four sides.

    Each touch, with ``speed_m_s``, begins where the first did.
    """
    # Between its walls a peg has nothing below it, and sinks.
    begun = (await motions.press(press_n, _SETTLE_S, never)).last
    depth_m = float(begun.task_position_tip_m[2])
    felt = class_by_force(begun.force_n, task.cell)
    if felt is ContactClass.END_FACE and depth_m <= task.fit.entry_depth_m:
        return ClassifiedContact(begun, felt)
    threshold_n = light_threshold_n(task.cell, press_n)
    travel_m = threshold_n / task.cell.stiffness_n_m + 2 * task.fit.clearance_m + _TRAVEL_M
    resisted = []
    for x, y in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
        touched = await motions.touch(np.array([x, y, 0.0]), travel_m, threshold_n, speed_m_s)
        resisted.append(touched.ended is Ended.FORCE)
        await _return(motions, begun, press_n, 2 * threshold_n, speed_m_s)
    first, second, third, fourth = resisted
    found = class_by_touches((first, second, third, fourth), depth_m, task.fit.entry_depth_m, felt)
    return ClassifiedContact(begun, found)


async def _return(
    motions: ContactMotions,
    begun: ContactSample,
    press_n: float,
    side_force_n: float,
    speed_m_s: float,
) -> None:
    # Between the touches the peg may have sunk behind a wall: it is not pressed against that, and
    # meets it no faster than in a touch.
    back = begun.task_position_tip_m[None, :2]
    speed_m_s = min(_TRAVEL_M / _SETTLE_S, speed_m_s)
    await motions.slide(back, press_n, speed_m_s, never, side_force_n)
