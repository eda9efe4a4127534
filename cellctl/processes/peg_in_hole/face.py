"""The face of the hole, touched at three points and proved at a fourth.

Its height is never taken from vision: every depth of search, insertion and verdict counts from this
plane. Source: section 2 (S1b, S1c) of the study of insertion by touch.
"""

from dataclasses import dataclass
from math import radians

import numpy as np
from numpy.typing import NDArray

from cellctl.cell.by_touch.motions import ContactMotions, Ended
from cellctl.errors.by_touch import FaceAbsent, FaceTilted, FaceUneven
from cellctl.processes.peg_in_hole.parameters import touch_speed_m_s
from cellctl.processes.peg_in_hole.task import SearchTask

Array = NDArray[np.float64]

_OVER_PLANE_M = 0.4e-3
_BEYOND_M = 2e-3
_MOST_RESIDUAL_M = 0.1e-3
_MOST_TILT_RAD = radians(3)
_FREE_M_S = 20e-3
_UPRIGHT = np.zeros(3)
_DOWN = np.array([0.0, 0.0, 1.0])
_ANGLES_RAD = np.radians([0.0, 120.0, 240.0, 60.0])
"""Three for the plane, the fourth between two of them to prove it."""


@dataclass(frozen=True, slots=True, eq=False)
class TouchedFace:
    """A plane in frame A as it was before it is turned to the face."""

    depth_m: float
    """At the search centre."""
    slope: Array
    """Depth per way along x and y, shape (2,)."""
    residual_m: float
    """Of the fourth touch, away from the plane of the others."""
    slope_sigma: float
    """Standard deviation of each component of ``slope``."""

    @property
    def tilt_rad(self) -> float:
        """Between the normal of the face and z of frame A."""
        return float(np.arctan(np.hypot(*self.slope)))

    def depth_at_m(self, xy_m: Array) -> float:
        """Depth of the plane at a point (2,)."""
        return self.depth_m + float(self.slope @ xy_m)


async def touch_face(
    motions: ContactMotions, task: SearchTask, radius_m: float, height_uncertainty_m: float
) -> TouchedFace:
    """Touch on a circle round the search centre; the first point fast, since its height is unknown.

    Raises ``FaceAbsent``, ``FaceUneven`` and ``FaceTilted``.
    """
    places = radius_m * np.stack([np.cos(_ANGLES_RAD), np.sin(_ANGLES_RAD)], axis=1)
    # The arm may press harder where nothing is known yet; vision's height may be wrong by much.
    fast_m_s = touch_speed_m_s(
        task.cell.stiffness_n_m, task.cell.dead_time_s, task.limits.insertion_n / 2
    )
    above_m = height_uncertainty_m + _OVER_PLANE_M
    reach_m = 2 * height_uncertainty_m + _OVER_PLANE_M + _BEYOND_M
    first_m = await _touch(motions, task, places[0], -above_m, reach_m, speed_m_s=fast_m_s)
    depths = [first_m]
    for place in places[1:]:
        # A face that is tilted by as much as is allowed is still met from above.
        apart_m = float(np.linalg.norm(place - places[0]))
        above_m = _OVER_PLANE_M + apart_m * float(np.tan(_MOST_TILT_RAD))
        depths.append(
            await _touch(motions, task, place, first_m - above_m, 2 * above_m + _BEYOND_M)
        )
    return _checked(places, np.array(depths), task, radius_m)


async def _touch(
    motions: ContactMotions,
    task: SearchTask,
    place_m: Array,
    from_m: float,
    travel_m: float,
    *,
    speed_m_s: float | None = None,
) -> float:
    await motions.back_out(-from_m)
    await motions.move_free(np.array([*place_m, from_m]), _UPRIGHT, _FREE_M_S)
    touched = await motions.touch(_DOWN, travel_m, task.limits.search_n, speed_m_s)
    if touched.ended is not Ended.FORCE:
        x_mm, y_mm = place_m * 1e3
        raise FaceAbsent(
            f"no contact at x {x_mm:.1f}, y {y_mm:.1f} mm within {travel_m * 1e3:.1f} mm"
        )
    return float(touched.last.task_position_tip_m[2])


def _checked(places: Array, depths: Array, task: SearchTask, radius_m: float) -> TouchedFace:
    design = np.column_stack([np.ones(3), places[:3]])
    depth_m, *slope = np.linalg.solve(design, depths[:3])
    residual_m = float(depths[3] - np.array([1.0, *places[3]]) @ [depth_m, *slope])
    # Three points 120 degrees apart: each slope has the variance 2 σ² / (3 r²).
    sigma = task.cell.height_sigma_m / radius_m * float(np.sqrt(2 / 3))
    face = TouchedFace(float(depth_m), np.array(slope), residual_m, sigma)
    if abs(residual_m) > _MOST_RESIDUAL_M:
        raise FaceUneven(
            f"{residual_m * 1e3:.3f} mm beside the plane, at most {_MOST_RESIDUAL_M * 1e3:.1f} mm"
        )
    if face.tilt_rad > _MOST_TILT_RAD:
        tilt_deg = float(np.degrees(face.tilt_rad))
        raise FaceTilted(f"{tilt_deg:.1f}°, at most {np.degrees(_MOST_TILT_RAD):.0f}°")
    return face
