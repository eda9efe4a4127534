"""Motions by touch over a height map: no dynamics, the errors and costs of section 3.3.

Every answer follows from where the peg truly stands. Time is counted, not spent. What is modelled:
a prior of the hole's place, repeatability and wander of the path, noise of heights and forces, tilt
of the face that is left after alignment, dead time after a condition holds. What is not: elastic
tilt, dirt, friction beyond thresholds.
"""

import numpy as np
from numpy.typing import NDArray

from cellctl.cell.contact_motion.motions import (
    Condition,
    ContactMotion,
    ContactMotions,
    ContactSample,
    Ended,
)
from cellctl.processes.peg_in_hole.plan.parameters import search_parameters
from cellctl.processes.peg_in_hole.plan.task import SearchTask
from tests.rigs.insertion.surface import Surface, Truth, correlated

Array = NDArray[np.float64]

TICK_S = 0.01
_TOUCH_S, _TURN_S = 0.8, 2.5
_WANDER_M, _WANDER_LENGTH_M = 0.02e-3, 5e-3
_TURN_SIGMA_M = 0.02e-3
_READING_S = 0.1
"""Readings of a height that are so far apart are independent."""
_EVERY = 20
"""Over a flat face one tick in so many is looked at, because nothing changes there."""


class KinematicMotions(ContactMotions):
    """A peg over a plate or a plug."""

    def __init__(self, task: SearchTask, truth: Truth, rng: np.random.Generator) -> None:
        self.task, self.truth, self._rng = task, truth, rng
        self._surface = Surface(task.fit, truth)
        parameters = search_parameters(task)
        self._touch_speed = parameters.touch_speed.value
        self._sink_speed = parameters.sink_speed.value
        self.time_s = 0.0
        self.touches = 0
        self.position_m: Array = np.array([0.0, 0.0, -5e-3])
        self.rotation_rad: Array = np.zeros(3)
        self._offset_m: Array = np.zeros(2)
        """Where the tip truly is beside where the encoders say."""
        self._wander_m: Array = np.zeros(2)

    @property
    def true_offset_m(self) -> Array:
        """Offset of the tip from the axis of the hole, shape (2,)."""
        return self.position_m[:2] + self._offset_m + self._wander_m - self.truth.hole_m

    async def move_free(
        self, task_position_tip_m: Array, task_rotation_tip_rad: Array, speed_m_s: float
    ) -> ContactMotion:
        target = np.asarray(task_position_tip_m, dtype=float)
        if not np.allclose(task_rotation_tip_rad, self.rotation_rad):
            self._turned(task_rotation_tip_rad)
        else:
            # Short ways between touches are part of the time of a touch.
            far_m = float(np.linalg.norm(target - self.position_m)) - 5e-3
            self.time_s += max(far_m, 0.0) / speed_m_s
            self._approach()
        self.position_m = target.copy()
        return self._ended(Ended.TRAVEL, 0.0)

    async def touch(
        self,
        direction: Array,
        travel_m: float,
        force_n: float,
        speed_m_s: float | None = None,
        until: Condition | None = None,
    ) -> ContactMotion:
        speed = speed_m_s or self._touch_speed
        self.touches += 1
        if abs(direction[2]) > 0.5:
            gap_m = self._depth_m() - self.position_m[2]
        else:
            gap_m = self._side_gap_m(direction[:2], force_n)
        way_m = min(max(gap_m, 0.0), travel_m)
        self.time_s += _TOUCH_S + way_m / speed
        self.position_m = self.position_m + way_m * direction
        if way_m == gap_m:
            noise_m = float(self._rng.normal(0, self.task.cell.height_sigma_m))
            self.position_m = self.position_m + noise_m * direction
            sample = self._sample(0.0)
            sample.force_n[:] -= force_n * direction
            return ContactMotion(Ended.FORCE, (sample,))
        return self._ended(Ended.TRAVEL, 0.0)

    async def press(
        self, force_n: float, hold_s: float, until: Condition | None = None
    ) -> ContactMotion:
        samples: list[ContactSample] = []
        rests_m = self._depth_m()
        end_s = self.time_s + hold_s
        while self.time_s < end_s:
            self.time_s += TICK_S
            sunk_m = self.position_m[2] + self._sink_speed * TICK_S
            self.position_m[2] = min(rests_m, sunk_m)
            samples.append(self._sample(force_n if sunk_m >= rests_m else 0.0))
            if self._between_walls:
                self._centre()
            if until is not None and until(samples[-1]):
                return ContactMotion(Ended.CONDITION, tuple(samples))
        return ContactMotion(Ended.TIME, tuple(samples))

    async def slide(
        self,
        way_m: Array,
        press_n: float,
        speed_m_s: float,
        until: Condition,
        side_force_n: float,
    ) -> ContactMotion:
        ticks = self._along(way_m, speed_m_s)
        if self._between_walls:
            # Between walls the peg stays in its hole, however far the arm has yielded.
            self.time_s += len(ticks) * TICK_S
            self.position_m[:2] = ticks[-1]
            return self._ended(Ended.TRAVEL, press_n)
        wander = self._wandering(len(ticks), speed_m_s * TICK_S)
        offsets = ticks + self._offset_m + wander - self.truth.hole_m
        depths = self._surface.depths_m(offsets, ticks, self.rotation_rad)
        heights = self._noise(len(ticks)) + depths
        lost = self._surface.carries_not(offsets, self.rotation_rad)
        begin_s, begin_m = self.time_s, float(self.position_m[2])
        stop = len(ticks) - 1
        ended = Ended.TRAVEL
        for index in _worth_asking(depths, lost, flat=not np.any(self.rotation_rad)):
            self.time_s = begin_s + (index + 1) * TICK_S
            self.position_m = np.array([*ticks[index], heights[index]])
            if until(self._sample(0.0 if lost[index] else press_n)):
                # Half of the dead time has passed before the condition could be seen to hold.
                stop = min(index + round(self.task.cell.dead_time_s / 2 / TICK_S), stop)
                ended = Ended.CONDITION
                break
        self.time_s = begin_s + (stop + 1) * TICK_S
        sunk_m = self._sunk_m(begin_m, heights[: stop + 1], lost[: stop + 1])
        self.position_m = np.array([*ticks[stop], sunk_m])
        self._wander_m = wander[stop]
        return self._ended(ended, press_n)

    async def turn(
        self,
        task_rotation_tip_rad: Array,
        hold_force_n: Array,
        speed_rad_s: float,
        until: Condition | None = None,
    ) -> ContactMotion:
        self._turned(task_rotation_tip_rad, speed_rad_s)
        return self._ended(Ended.TRAVEL, float(hold_force_n[2]))

    async def comply(
        self,
        press_n: float,
        hold_s: float,
        until: Condition | None = None,
        *,
        turns: bool = True,
    ) -> ContactMotion:
        self.time_s += hold_s
        return self._ended(Ended.TIME, press_n)

    async def feed(
        self,
        depth_m: float,
        force_limit_n: float,
        until: Condition | None = None,
        past_m: float = 0.0,
    ) -> ContactMotion:
        depth_m = max(depth_m + past_m, float(self.position_m[2]))
        if self._between_walls or self._depth_m() > self.task.fit.entry_depth_m:
            self._centre()
        rests_m = self._depth_m()
        # Against a stop the force rises with the way of the arm.
        yields_m = force_limit_n / self.task.cell.stiffness_n_m
        samples: list[ContactSample] = []
        ended = Ended.TRAVEL
        for at_m in (rests_m, rests_m + yields_m / 2, rests_m + yields_m):
            reached_m = min(at_m, depth_m)
            self.time_s += max(reached_m - self.position_m[2], 0.0) / self._touch_speed
            self.position_m[2] = reached_m
            press_n = max(reached_m - rests_m, 0.0) * self.task.cell.stiffness_n_m
            samples.append(self._sample(press_n))
            if until is not None and until(samples[-1]):
                return ContactMotion(Ended.CONDITION, tuple(samples))
            ended = Ended.TRAVEL if at_m > depth_m else Ended.FORCE
        return ContactMotion(ended, tuple(samples))

    async def back_out(self, height_m: float) -> ContactMotion:
        self.position_m[2] = -height_m
        return self._ended(Ended.TRAVEL, 0.0)

    @property
    def _between_walls(self) -> bool:
        """A tilted peg dips as deep without standing in anything."""
        upright = not np.any(self.rotation_rad)
        return bool(upright and self.position_m[2] > self.task.fit.entry_depth_m)

    def _centre(self) -> None:
        """The chamfers bring a peg that gives way to where it stands free between the walls."""
        if np.hypot(*self.true_offset_m) > self.task.fit.clearance_m:
            self.position_m[:2] -= self.true_offset_m

    def _turned(self, rotation_rad: Array, speed_rad_s: float = 0.0) -> None:
        """A large turn costs what the reference counts for it, a small one its own time."""
        angle_rad = float(np.linalg.norm(rotation_rad - self.rotation_rad))
        self.time_s += min(_TURN_S, angle_rad / speed_rad_s) if speed_rad_s else _TURN_S
        self.rotation_rad = np.asarray(rotation_rad, dtype=float).copy()
        self._approach()
        self._offset_m = self._offset_m + self._rng.normal(0, _TURN_SIGMA_M, 2)

    def _approach(self) -> None:
        self._offset_m = self._rng.normal(0, self.task.cell.repeatability_m, 2)
        self._wander_m = np.zeros(2)

    def _depth_m(self) -> float:
        """Depth of the tip where it rests, below its present place."""
        here = self.position_m[None, :2]
        return float(
            self._surface.depths_m(self.true_offset_m[None, :], here, self.rotation_rad)[0]
        )

    def _sunk_m(self, begin_m: float, heights: Array, lost: NDArray[np.bool_]) -> float:
        """Depth at the end of a slide: a peg that nothing carries sinks slowly."""
        carried = np.flatnonzero(~lost)
        last = int(carried[-1]) if len(carried) else -1
        from_m = float(heights[last]) if len(carried) else begin_m
        sunk_m = from_m + self._sink_speed * TICK_S * (len(lost) - 1 - last)
        return min(float(heights[-1]), sunk_m)

    def _side_gap_m(self, direction: Array, force_n: float) -> float:
        gap_m, inside = self._surface.side_gap_m(
            self.true_offset_m, float(self.position_m[2]), direction
        )
        # The wall of a hole is felt once the arm has given way by the force; the outer face of a
        # plug is met at full speed.
        return gap_m + force_n / self.task.cell.stiffness_n_m if inside else gap_m

    def _along(self, way_m: Array, speed_m_s: float) -> Array:
        """Points of a way at every tick, shape (n, 2)."""
        corners = np.vstack([self.position_m[:2], way_m])
        lengths = np.concatenate(
            [[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))]
        )
        count = max(1, int(np.ceil(lengths[-1] / (speed_m_s * TICK_S))))
        at = np.linspace(0, lengths[-1], count + 1)[1:]
        return np.stack([np.interp(at, lengths, corners[:, axis]) for axis in (0, 1)], axis=1)

    def _wandering(self, count: int, step_m: float) -> Array:
        keep = float(np.exp(-step_m / _WANDER_LENGTH_M))
        return correlated(self._rng, count, keep, _WANDER_M, self._wander_m)

    def _noise(self, count: int) -> Array:
        keep = float(np.exp(-TICK_S / _READING_S))
        begin = self._rng.normal(0, self.task.cell.height_sigma_m, 1)
        return correlated(self._rng, count, keep, self.task.cell.height_sigma_m, begin)[:, 0]

    def _sample(self, press_n: float) -> ContactSample:
        sigma_n = self.task.cell.force_sigma_n
        force = self._rng.normal(0, sigma_n, 3)
        force[2] -= press_n
        return ContactSample(
            self.time_s,
            self.position_m.copy(),
            self.rotation_rad,
            force,
            np.zeros(3),
            sigma_n,
        )

    def _ended(self, ended: Ended, press_n: float) -> ContactMotion:
        return ContactMotion(ended, (self._sample(press_n),))


def _worth_asking(depths: Array, lost: NDArray[np.bool_], *, flat: bool) -> NDArray[np.int64]:
    """Ticks at which a condition could answer anything new; all of them for a tilted peg."""
    if not flat:
        return np.arange(len(depths))
    near = lost.copy()
    near[1:] |= lost[:-1]
    near[::_EVERY] = True
    near[-1] = True
    return np.flatnonzero(near)
