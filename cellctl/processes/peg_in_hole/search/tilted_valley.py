"""A tilted peg feels its way along a valley that leads to the hole.

Source: section 3.4 of the study of insertion by touch. Positions are those of the centre of the
peg's bottom.
"""

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from cellctl.cell.contact_motion.motions import ContactMotion, ContactSample, Ended, never
from cellctl.force.contact.spirals import spiral_points
from cellctl.force.contact.streamed.speeds import DETECTION_S
from cellctl.processes.peg_in_hole.plan.choice import SearchName
from cellctl.processes.peg_in_hole.search.conditions import Bottomed, Stop
from cellctl.processes.peg_in_hole.search.probe import Felt, TouchProbe
from cellctl.processes.peg_in_hole.search.strategy import SearchStrategy
from cellctl.processes.peg_in_hole.search.tilted_touch import leaning

Array = NDArray[np.float64]

_TOWARDS = np.array([1.0, 0.0])
_ACROSS = np.array([0.0, 1.0])
_FALLEN_DIPS = 1.4
"""On the edge of a hole a tilted peg rests deeper by r θ c / e than far from it, at a distance e
from its axis: with this dip it stands within 2.5 c."""
_NEAR_DIPS = 0.75
"""With this dip, and in the middle of the valley, the hole is half a radius ahead."""
_DOWNHILL_SPEEDS = 3.0
"""Multiple of the speed of a touch: the arm does not press while the face falls away."""
_ACROSS_SPEEDS = 1.5
"""Up the flanks, where the arm presses as it climbs."""
_BACK_SPEEDS = 2.0
"""Near the wall the peg may stand in the mouth, and is not to be torn out."""
_FORCE_SHARE = 0.75
"""Flanks are steep: press and side force add up, and the arm presses more as it climbs."""
_RESTS_N, _RESTS_SIGMAS = 0.8, 4.0
"""A peg that nothing pushes sideways with more has come to rest; or with more than the noise."""
_LET_GO = 12
"""Times that a peg may come to lean on a flank on its way along the valley. Let go, friction keeps
it beside the middle by as much as press and slope allow, so that it soon leans there again."""
_BACK_M = (0.0, 0.4e-3, 0.12e-3)
"""Steps back from the wall before each crossing: where the valley is narrow it is found best."""


class TiltedValley(SearchStrategy):
    """Search for tight holes in a plate: what it feels does not shrink with the clearance."""

    name: ClassVar[SearchName] = SearchName.TILTED_VALLEY

    async def find(self, probe: TouchProbe) -> bool:
        """Peck until a touch dips, follow the valley to its wall, stand up there."""
        tilt_rad = probe.parameters.tilt.value
        peg_m, bore_m = probe.task.fit.peg_radius_m, probe.task.fit.bore_radius_m
        flat_m = -peg_m * np.sin(tilt_rad)
        rotation = leaning(_TOWARDS, tilt_rad)
        reach_m = max(probe.task.search_radius_m, 1.1 * bore_m)
        for target_m in spiral_points(reach_m, bore_m / 2):
            at_m = target_m - peg_m * np.cos(tilt_rad) * _TOWARDS
            dip_m = await _confirmed_dip(probe, at_m, rotation, flat_m)
            if dip_m is None:
                continue
            centre_m = await _Valley(probe, flat_m).follow(at_m, dip_m)
            if centre_m is not None and await probe.look_round(centre_m):
                return True
        return False


async def _confirmed_dip(
    probe: TouchProbe, at_m: Array, rotation: Array, flat_m: float
) -> float | None:
    """The smaller dip of two touches; None when one of them is as high as the face."""
    dips_m: list[float] = []
    for _ in range(2):
        expected_m = flat_m + (dips_m[0] if dips_m else 0.0)
        sample = await probe.touch_down(at_m, rotation, expected_m)
        dips_m.append(float(sample.task_position_tip_m[2]) - flat_m)
        dipped = dips_m[-1] > probe.parameters.dip_threshold.value
        probe.trace.note(sample, Felt.DIP if dipped else Felt.FACE)
        if not dipped:
            return None
    return min(dips_m)


class _Valley:
    """Follows one valley from a point in it."""

    def __init__(self, probe: TouchProbe, flat_m: float) -> None:
        self._probe = probe
        self._flat_m = flat_m
        self._full_m = probe.parameters.tilted_dip.value
        self._speed = probe.parameters.touch_speed.value
        self._reach_m = 2 * probe.task.fit.bore_radius_m
        self._here_m: Array = np.zeros(2)
        self._arrived = False
        """True once the peg is in the hole, or stands against its far wall."""

    async def follow(self, at_m: Array, dip_m: float) -> Array | None:
        """Bottom centre (2,) at the wall, or where the peg fell in; None where no valley is."""
        half_m = dip_m / 2
        for back_m in _BACK_M:
            if back_m:
                at_m = await self._step_to(at_m - back_m * _TOWARDS, _BACK_SPEEDS)
            middle_m = await self._middle(at_m, half_m)
            if self._arrived:
                return self._here_m
            if middle_m is None:
                return None
            wall_m = await self._wall(await self._step_to(middle_m))
            if wall_m is None or self._arrived:
                return wall_m
            at_m = wall_m
            # Near the wall the valley is at its deepest, so a fixed share of the full dip serves.
            half_m = 0.3 * self._full_m
        return at_m

    async def _middle(self, at_m: Array, half_m: float) -> Array | None:
        """Middle between the two sides; None when a side has no end, or the peg fell in."""
        sides_m = []
        for sign in (1.0, -1.0):
            end_m = at_m + sign * self._reach_m * _ACROSS
            beyond = _SideReached(self, at_m, sign, half_m)
            motion = await self._slide(end_m, _ACROSS_SPEEDS * self._speed, beyond)
            if motion.ended is Ended.FORCE and self._near_hole(motion.last):
                # A stiff arm cannot climb a flank that is so steep: the peg finds the middle.
                return await self._let_go()
            self._arrived = beyond.fallen
            if self._arrived or motion.ended is Ended.TRAVEL:
                return None
            self._probe.trace.note(motion.last, Felt.EDGE)
            sides_m.append(self._here_m)
            if sign > 0:
                # From the bottom of the valley on the way to the other side goes on at once.
                await self._downhill_to(at_m, _DOWNHILL_SPEEDS)
        return np.asarray((sides_m[0] + sides_m[1]) / 2)

    async def _wall(self, at_m: Array) -> Array | None:
        """Slide forward until the dip has fallen to half of its greatest; the place (2,) of the
        wall.

        None where nothing has ended the slide. The speed is 1.25 times that of a touch, and the
        next crossing looks for 0.3 of the full dip (both section 3.4).
        """
        begin_m = at_m
        for _ in range(_LET_GO):
            stop = _WallReached(self)
            end_m = begin_m + self._reach_m * _TOWARDS
            motion = await self._slide(end_m, 1.25 * self._speed, stop)
            self._arrived = stop.fallen
            against = _ahead(motion.last) and self._near_hole(motion.last)
            if motion.ended is not Ended.FORCE or against:
                break
            # It leans on a flank, beside the middle of the valley: the way goes on there.
            begin_m = await self._let_go()
        self._probe.trace.note(motion.last, Felt.WALL)
        if motion.ended is Ended.TRAVEL:
            return None
        if self._arrived:
            return self._here_m
        if motion.ended is Ended.FORCE:
            # What stands in its way is the far wall of the hole, with the mouth below the peg.
            await self._let_go()
            self._arrived = True
            return self._here_m
        # The arm had gone on while the average followed and the stop took effect.
        late_s = DETECTION_S + self._probe.task.cell.dead_time_s / 2
        return np.asarray(self._here_m - 1.25 * self._speed * late_s * _TOWARDS)

    async def _let_go(self) -> Array:
        """Where the peg comes to rest (2,) when nothing holds it sideways."""
        rests = await self._probe.let_go(self._rests)
        self._here_m = rests.task_position_tip_m[:2].copy()
        self._arrived = self.fell_in(self.dip_m(rests))
        return self._here_m

    def _rests(self, sample: ContactSample) -> bool:
        side_n = float(np.hypot(*sample.force_n[:2]))
        least_n = max(_RESTS_N, _RESTS_SIGMAS * self._probe.task.cell.force_sigma_n)
        return side_n < least_n or self.fell_in(self.dip_m(sample))

    async def _step_to(self, point_m: Array, speeds: float = _DOWNHILL_SPEEDS) -> Array:
        """Faster as long as it goes downhill."""
        if await self._downhill_to(point_m, speeds) is Ended.CONDITION:
            await self._slide(point_m, _ACROSS_SPEEDS * self._speed, never)
        return point_m

    async def _downhill_to(self, point_m: Array, speeds: float) -> Ended:
        """Ends by ``CONDITION`` where the face no longer falls away before the peg."""
        return (await self._slide(point_m, speeds * self._speed, Bottomed())).ended

    async def _slide(self, point_m: Array, speed_m_s: float, until: Stop) -> ContactMotion:
        motion = await self._probe.slide(point_m[None, :], speed_m_s, until, share=_FORCE_SHARE)
        self._here_m = motion.last.task_position_tip_m[:2].copy()
        return motion

    def dip_m(self, sample: ContactSample) -> float:
        """How deep the peg stands below a touch beside the hole."""
        return float(sample.task_position_tip_m[2]) - self._flat_m

    def _near_hole(self, sample: ContactSample) -> bool:
        """Only there the flanks are steep, and a wall stands ahead."""
        return self.dip_m(sample) > _NEAR_DIPS * self._full_m

    def fell_in(self, dip_m: float) -> bool:
        """Deeper than any resting tilted peg."""
        return dip_m > _FALLEN_DIPS * self._full_m


def _ahead(sample: ContactSample) -> bool:
    """Whether what pushes the peg stands in its way, not beside it."""
    return abs(float(sample.force_n[0])) > abs(float(sample.force_n[1]))


class _Average:
    """First-order average of the dip, because single readings of a height are noisy."""

    def __init__(self, valley: _Valley) -> None:
        self._valley = valley
        self._value_m = 0.0
        self._time_s: float | None = None

    def __call__(self, sample: ContactSample) -> float:
        dip_m = self._valley.dip_m(sample)
        if self._time_s is None:
            self._value_m = dip_m
        else:
            weight = 1 - np.exp(-(sample.time_s - self._time_s) / DETECTION_S)
            self._value_m += float(weight) * (dip_m - self._value_m)
        self._time_s = sample.time_s
        return self._value_m


class _SideReached:
    """Holds beyond the start, where the peg stands higher than a threshold, or fell in."""

    def __init__(self, valley: _Valley, at_m: Array, sign: float, half_m: float) -> None:
        self._valley, self._at_m, self._sign, self._half_m = valley, at_m, sign, half_m
        self._average = _Average(valley)
        self.fallen = False

    def __call__(self, sample: ContactSample) -> bool:
        dip_m = self._average(sample)
        self.fallen = self._valley.fell_in(dip_m)
        passed_m = self._sign * ((sample.task_position_tip_m[:2] - self._at_m) @ _ACROSS)
        return self.fallen or bool(passed_m > 0 and dip_m < self._half_m)


class _WallReached:
    """Holds where the dip has fallen to half of its greatest, or the peg fell in."""

    def __init__(self, valley: _Valley) -> None:
        self._valley = valley
        self._average = _Average(valley)
        self._greatest_m = 0.0
        self.fallen = False

    def __call__(self, sample: ContactSample) -> bool:
        dip_m = self._average(sample)
        self._greatest_m = max(self._greatest_m, dip_m)
        self.fallen = self._valley.fell_in(dip_m)
        return self.fallen or dip_m < self._greatest_m / 2
