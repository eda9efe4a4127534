"""The face of the hole, touched at three points and proved at a fourth.

Its height is never taken from vision: every depth of search, insertion and verdict counts from this
plane. Source: section 2 (S1b, S1c) of the study of insertion by touch.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import takewhile
from math import radians

import numpy as np
from numpy.typing import NDArray

from cellctl.cell.contact_motion.motions import ContactMotions, ContactSample, Ended
from cellctl.processes.peg_in_hole.faults import (
    FaceAbsent,
    FaceTilted,
    FaceUneven,
    PegSlipped,
)
from cellctl.processes.peg_in_hole.plan.parameters import touch_speed_m_s
from cellctl.processes.peg_in_hole.plan.task import SearchTask

Array = NDArray[np.float64]

_OVER_PLANE_M = 0.4e-3
"""Height over the predicted plane from which a touch begins (S1b)."""
_BEYOND_M = 2e-3
"""How far beyond the deepest place that is expected a touch goes before the face is absent
(S1b)."""
_SLIP_M, _WAY_RATIO = 0.5e-3, 2.0
"""A part has slipped in its fingers when a touch goes on in contact for this way, and for this
multiple of the way on which the stiffness of the cell makes the force of a touch."""
_FELT_N, _FELT_SIGMAS = 1.0, 5.0
"""Least axial force of a touch, in newtons and in standard deviations: in the air none is so
great."""
_MOST_RESIDUAL_M, _MOST_TILT_RAD = 0.1e-3, radians(3)
"""Largest distance of the fourth touch from the plane of the others, and largest tilt of that
plane; beyond them the face is refused (S1b)."""
_FREE_M_S = 20e-3
"""Greatest speed from touch to touch; the motion itself goes slower where it might meet
something."""
CLEAR_M = 1e-3
"""Height over the face at which the tip is left after the touches."""
_CLEAR_M = 3e-3
"""Height over a plug that stands proud of the touched panel."""
_UPRIGHT = np.zeros(3)
_DOWN = np.array([0.0, 0.0, 1.0])
ANGLES_RAD = np.radians([0.0, 60.0, 120.0, 240.0])
"""Directions of the touches in their order: three for the plane, and one between two of them to
prove it."""
_OF_PLANE, _PROOF = [0, 2, 3], 1
_STEP_RAD = radians(30)
"""Angle of one step of the way round a plug: so short, its corners stay near the circle."""


@dataclass(frozen=True, slots=True, eq=False)
class TouchedFace:
    """A plane in frame A as it was before it is turned to the face."""

    depth_m: float
    """Depth of the face at the search centre."""
    slope: Array
    """Depth per way along x and y, shape (2,)."""
    residual_m: float
    """Distance of the fourth touch from the plane of the others."""
    slope_sigma: float
    """Standard deviation of each component of ``slope``."""
    yields_m: float = 0.0
    """How far arm and face had yielded under the touches: the plane lies deeper than the free face
    by this."""

    @property
    def tilt_rad(self) -> float:
        """Angle between the normal of the face and z of frame A."""
        return float(np.arctan(np.hypot(*self.slope)))


@dataclass(frozen=True, slots=True)
class FacePlan:
    """Where the face is touched."""

    radius_m: float
    """Radius of the circle of touches round the search centre."""
    height_uncertainty_m: float
    datum_depth_m: float = 0.0
    """How much deeper than the face the plane lies that is touched: the panel round a plug."""


async def touch_face(motions: ContactMotions, task: SearchTask, plan: FacePlan) -> TouchedFace:
    """Touch on a circle round the search centre; the first point fast, since its height is unknown.

    Raises ``FaceAbsent``, ``FaceUneven``, ``FaceTilted`` and ``PegSlipped``.
    """
    radius_m, height_uncertainty_m = plan.radius_m, plan.height_uncertainty_m
    touching = _Touching(motions, task, plan.datum_depth_m, height_uncertainty_m)
    places = np.stack([_on_circle(float(angle_rad), radius_m) for angle_rad in ANGLES_RAD])
    # The arm may press harder where nothing is known yet; vision's height may be wrong by much.
    fast_m_s = touch_speed_m_s(
        task.cell.stiffness_n_m, task.cell.dead_time_s, task.limits.insertion_n / 2
    )
    above_m = height_uncertainty_m + _above_m(radius_m)
    reach_m = above_m + height_uncertainty_m + _BEYOND_M
    await touching.over_first(places[0], plan.datum_depth_m - above_m)
    touches = [await touching.at(places[0], reach_m, speed_m_s=fast_m_s)]
    first_m = _depth_m(touches[0])
    for angle_rad, place in zip(ANGLES_RAD[1:], places[1:], strict=True):
        above_m = _above_m(float(np.linalg.norm(place - places[0])))
        await touching.over_next(float(angle_rad), radius_m, first_m - above_m)
        touches.append(await touching.at(place, 2 * above_m + _BEYOND_M))
    await touching.leave(places[-1], first_m - above_m)
    depths = np.array([_depth_m(touch) for touch in touches])
    pressed_n = np.array([-touch.force_n[2] for touch in touches])[_OF_PLANE]
    face = _checked(places, depths - plan.datum_depth_m, task, radius_m)
    return replace(face, yields_m=float(np.mean(pressed_n)) / task.cell.stiffness_n_m)


def _above_m(apart_m: float) -> float:
    """Height over a point of known height from which a touch ``apart_m`` beside it still comes from
    above, if the face is tilted as far as is allowed."""
    return _OVER_PLANE_M + apart_m * float(np.tan(_MOST_TILT_RAD))


def _depth_m(touch: ContactSample) -> float:
    return float(touch.task_position_tip_m[2])


@dataclass(frozen=True, slots=True)
class _Touching:
    motions: ContactMotions
    task: SearchTask
    datum_depth_m: float
    height_uncertainty_m: float

    async def over_first(self, place_m: Array, from_m: float) -> None:
        """Move from over the search centre to a place (2,), at depth ``from_m``."""
        over_m = self._over_m(from_m)
        await self.motions.back_out(-over_m)
        await self._over(place_m, over_m)
        if over_m < from_m:
            await self._over(place_m, from_m)

    async def over_next(self, angle_rad: float, radius_m: float, from_m: float) -> None:
        """Move from the last place to the next one, round a plug that stands in the way."""
        begun = await self.motions.back_out(-from_m)
        if self.datum_depth_m > 0:
            x_m, y_m, _ = begun.last.task_position_tip_m
            here_rad = float(np.arctan2(y_m, x_m)) % (2 * np.pi)
            for place_m in _round_the_plug(here_rad, angle_rad, radius_m):
                await self._over(place_m, from_m)
        await self._over(_on_circle(angle_rad, radius_m), from_m)

    async def _over(self, place_m: Array, over_m: float) -> None:
        target = np.array([*place_m, over_m])
        moved = await self.motions.move_free(target, _UPRIGHT, _FREE_M_S)
        if moved.ended is Ended.FORCE:
            # A touch from here would be one of what stands in the way.
            x_mm, y_mm, depth_mm = moved.last.task_position_tip_m * 1e3
            raise FaceAbsent(
                f"something stands in the way to it at x {x_mm:.1f}, y {y_mm:.1f}, "
                f"depth {depth_mm:.1f} mm"
            )

    async def leave(self, place_m: Array, from_m: float) -> None:
        """Up from the last place (2,) by ``from_m``, straight, clear of a plug."""
        await self.motions.back_out(-from_m)
        await self._over(place_m, self._over_m(from_m))

    def _over_m(self, from_m: float) -> float:
        """High enough for a plug that stands proud of what is touched."""
        return from_m if self.datum_depth_m == 0 else -self.height_uncertainty_m - _CLEAR_M

    async def at(
        self, place_m: Array, travel_m: float, *, speed_m_s: float | None = None
    ) -> ContactSample:
        """The tip in contact at a place (2,), over which it stands."""
        touched = await self.motions.touch(_DOWN, travel_m, self.task.limits.search_n, speed_m_s)
        x_mm, y_mm = place_m * 1e3
        place = f"x {x_mm:.1f}, y {y_mm:.1f} mm"
        if touched.ended is not Ended.FORCE:
            _require_no_slip(touched.samples, self.task, self.task.limits.search_n, place)
            raise FaceAbsent(f"no contact at {place} within {travel_m * 1e3:.1f} mm")
        return touched.last


def _on_circle(angle_rad: float, radius_m: float) -> Array:
    return radius_m * np.array([np.cos(angle_rad), np.sin(angle_rad)])


def _round_the_plug(from_rad: float, to_rad: float, radius_m: float) -> list[Array]:
    """Corners (2,) of the way from one place on a circle to another, which it touches and never
    cuts."""
    steps = max(1, round((to_rad - from_rad) / _STEP_RAD))
    half_rad = (to_rad - from_rad) / (2 * steps)
    corners_rad = from_rad + half_rad * (2 * np.arange(steps) + 1)
    return [_on_circle(float(at), radius_m / float(np.cos(half_rad))) for at in corners_rad]


def _require_no_slip(
    samples: Sequence[ContactSample], task: SearchTask, force_n: float, place: str
) -> None:
    """Raise ``PegSlipped`` for a touch that met something and went on without ``force_n``.

    An arm that presses on something fixed feels more force with every bit of travel. Where the
    force stays the same, the arm pushes the part back into its fingers, with just the force of the
    grip.
    """
    least_n = max(_FELT_N, _FELT_SIGMAS * samples[-1].force_sigma_n)
    pushed = list(takewhile(lambda one: -one.force_n[2] >= least_n, reversed(samples)))
    if not pushed:
        return
    way_m = _depth_m(pushed[0]) - _depth_m(pushed[-1])
    if way_m < max(_SLIP_M, _WAY_RATIO * force_n / task.cell.stiffness_n_m):
        return
    carried_n = float(np.mean([-one.force_n[2] for one in pushed]))
    raise PegSlipped(
        f"the face carries {carried_n:.1f} N at {place}, and no more over {way_m * 1e3:.1f} mm"
    )


def _checked(places: Array, depths: Array, task: SearchTask, radius_m: float) -> TouchedFace:
    design = np.column_stack([np.ones(3), places[_OF_PLANE]])
    depth_m, *slope = np.linalg.solve(design, depths[_OF_PLANE])
    expected_m = float(np.array([1.0, *places[_PROOF]]) @ [depth_m, *slope])
    residual_m = float(depths[_PROOF]) - expected_m
    # Three points 120 degrees apart: each slope has the variance 2 σ² / (3 r²).
    sigma = task.cell.height_sigma_m / radius_m * float(np.sqrt(2 / 3))
    # What touches a tilted face is the rim of the peg and not its middle.
    ahead_m = task.fit.rim_radius_m * float(np.hypot(*slope))
    face = TouchedFace(float(depth_m) + ahead_m, np.array(slope), residual_m, sigma)
    if abs(residual_m) > _MOST_RESIDUAL_M:
        raise FaceUneven(
            f"{residual_m * 1e3:.3f} mm beside the plane, at most {_MOST_RESIDUAL_M * 1e3:.1f} mm"
        )
    if face.tilt_rad > _MOST_TILT_RAD:
        tilt_deg = float(np.degrees(face.tilt_rad))
        raise FaceTilted(f"{tilt_deg:.1f}°, at most {np.degrees(_MOST_TILT_RAD):.0f}°")
    return face
