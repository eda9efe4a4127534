"""Motions by touch for any robot that follows a stream, with the force guard beside it."""

from collections.abc import Callable, Coroutine
from typing import Any

import numpy as np

from cellctl.cell.contact_motion.contact_loop import ContactLoop
from cellctl.cell.contact_motion.giving_way import (
    TILT_X,
    TILT_Y,
    YAW,
    X,
    Y,
    Z,
    fastest_m_s,
    fastest_rad_s,
    giving_way,
)
from cellctl.cell.contact_motion.motion_rules.ends import End, SomethingMet, arrived, first_of, when
from cellctl.cell.contact_motion.motion_rules.feed import FeedRule
from cellctl.cell.contact_motion.motion_rules.free_speed import free_speed_m_s
from cellctl.cell.contact_motion.motions import (
    Condition,
    ContactMotion,
    ContactMotions,
    ContactSample,
    Ended,
    Vector,
)
from cellctl.cell.contact_motion.standing import HOLD_S, hold_while
from cellctl.cell.contact_motion.streamed_motion import Press, StreamedMotion
from cellctl.cell.contact_motion.ticks import MotionKind
from cellctl.errors.streamed_contact import StreamLate
from cellctl.force.contact.streamed.path import PathFollower, straight
from cellctl.force.contact.streamed.speeds import touch_speed_m_s
from cellctl.geometry.pose import MM, Array

_TURN_LEVER_M = 0.02
"""A turn on the way counts as the way of a point so far from the tip: about the length of a peg,
which may meet the part with the hole. What carries it swings through space that is kept free."""
_SHORTEST_M = 1e-6
"""A way shorter than this counts as this long, so that a speed along it can be stated at all."""
_LATEST_RATIO, _LATEST_S = 3.0, 10.0
"""A motion is given up after three times the time of its way at full speed, and 10 s. It ends only
what hangs: a late tick halves the speed, and a way of nothing still needs time to come to rest."""
_IN_CONTACT_N = 2.0
"""A force below this, or below four times the noise, is none on the way out. It decides only
between the slow and the fast speed."""
_PULL_RATIO = 2.0
"""Multiple of the press: a greater pull on the way out means that the peg is held. Friction alone
pulls with less than what the peg was pressed in with."""


class StreamedContact(ContactMotions):
    """See ``ContactMotions``; it is made by ``streamed_contact`` and lasts as long as its stream.

    Raises ``StreamLate``, ``ContactLost``, ``AdmittanceSaturated``, the fault of a guard that has
    tripped, or what the stream raises; the robot is then stopped when the stream is left.
    """

    def __init__(self, loop: ContactLoop) -> None:
        self._loop, self._settings = loop, loop.settings
        self.watched_n = loop.settings.limit_n
        """Force at which the guard stops the arm; ``watch_closer`` lowers it for a phase."""
        self._pressed_n = 0.0
        """Force with which the last motion pressed along z; a touch across z keeps pressing with
        it."""

    async def move_free(
        self, task_position_tip_m: Vector, task_rotation_tip_rad: Vector, speed_m_s: float
    ) -> ContactMotion:
        """See ``ContactMotions``."""
        self._pressed_n = 0.0
        target = np.concatenate([task_position_tip_m, task_rotation_tip_rad])
        points, lengths = straight(self._loop.tip_command, target, _TURN_LEVER_M)
        path = self._path(points, lengths)
        met = SomethingMet(self._settings.press_n, self._settings.figures.stiffness_n_m)
        way = target - self._loop.tip_command
        # The flange makes both at once, so that the steps of both add up.
        shift_s = float(np.linalg.norm(way[:3])) / fastest_m_s(self._loop)
        turn_s = float(np.linalg.norm(way[3:])) / fastest_rad_s(self._loop)
        least_s = max(shift_s + turn_s, self._loop.period_s)
        way_m = max(path.remaining, _SHORTEST_M)
        from_m, to_m = float(self._loop.tip_command[2]), float(target[2])
        free_m_s = free_speed_m_s(self._settings, self.watched_n, from_m, to_m, way_m)
        speed = min(speed_m_s, free_m_s, way_m / least_s)
        moved = await self._run(
            MotionKind.MOVE_FREE,
            path,
            lambda _sample: speed,
            first_of(met, arrived(path)),
            speed,
        )
        if moved.ended is Ended.TRAVEL:
            self._loop.trail.begin()
        return moved

    async def touch(
        self,
        direction: Vector,
        travel_m: float,
        force_n: float,
        speed_m_s: float | None = None,
        until: Condition | None = None,
    ) -> ContactMotion:
        """See ``ContactMotions``."""
        across = abs(float(direction[2])) < 1e-9  # but for the rounding of a unit vector
        if not across:
            self._pressed_n = 0.0
        target = self._loop.tip_command.copy()
        target[:3] += travel_m * np.asarray(direction)
        path = self._path(*straight(self._loop.tip_command, target, _TURN_LEVER_M))
        allowed = touch_speed_m_s(self._settings.figures, force_n)
        speed = min(speed_m_s or allowed, fastest_m_s(self._loop))
        press = self._press_along(self._pressed_n) if across and self._pressed_n else None

        def touched(sample: ContactSample) -> Ended | None:
            return Ended.FORCE if -float(sample.force_n @ direction) > force_n else None

        end = first_of(touched, when(until), arrived(path))
        return await self._run(
            MotionKind.TOUCH, path, lambda _sample: speed, end, speed, press=press
        )

    async def press(
        self, force_n: float, hold_s: float, until: Condition | None = None
    ) -> ContactMotion:
        """See ``ContactMotions``; raises ``ContactLost`` unless a condition waits for that."""
        self._pressed_n = force_n
        press = self._press_along(force_n, contact_must_stay=until is None)
        return await self._hold(MotionKind.PRESS, press, hold_s, until)

    async def slide(
        self,
        way_m: Vector,
        press_n: float,
        speed_m_s: float,
        until: Condition,
        side_force_n: float,
    ) -> ContactMotion:
        """See ``ContactMotions``."""
        self._pressed_n = press_n
        corners = np.tile(self._loop.tip_command, (len(way_m) + 1, 1))
        corners[1:, :2] = way_m
        lengths = np.linalg.norm(np.diff(corners[:, :2], axis=0), axis=1)
        path = self._path(corners, lengths)
        speed = min(speed_m_s, fastest_m_s(self._loop))

        def held(sample: ContactSample) -> Ended | None:
            side_n = float(np.hypot(*sample.force_n[:2]))
            return Ended.FORCE if side_n > side_force_n else None

        end = first_of(when(until), held, arrived(path))
        press = self._press_along(press_n)
        slid = await self._run(
            MotionKind.SLIDE, path, lambda _sample: speed, end, speed, press=press
        )
        self._loop.trail.begin()
        return slid

    async def turn(
        self,
        task_rotation_tip_rad: Vector,
        hold_force_n: Vector,
        speed_rad_s: float,
        until: Condition | None = None,
    ) -> ContactMotion:
        """See ``ContactMotions``; while it is held, the attitude gives way against a spring."""
        target = self._loop.tip_command.copy()
        target[3:] = task_rotation_tip_rad
        points, lengths = straight(self._loop.tip_command, target, 1.0)
        path = self._path(points, lengths, self._settings.acceleration_rad_s2)
        speed = min(speed_rad_s, fastest_rad_s(self._loop))
        held = tuple(int(axis) for axis in np.flatnonzero(hold_force_n))
        press = None
        if held:
            push = np.concatenate([hold_force_n, np.zeros(3)])
            press = giving_way(
                self._loop, push, (*held, TILT_X, TILT_Y), spring=self._settings.springs
            )
        end = first_of(when(until), arrived(path))
        return await self._run(
            MotionKind.TURN, path, lambda _sample: speed, end, speed, press=press
        )

    async def comply(
        self,
        press_n: float,
        hold_s: float,
        until: Condition | None = None,
        *,
        turns: bool = True,
    ) -> ContactMotion:
        """See ``ContactMotions``; raises ``ContactLost`` unless a condition waits for that."""
        self._pressed_n = press_n
        push = np.array([0.0, 0.0, press_n, 0.0, 0.0, 0.0])
        axes = (X, Y, Z, TILT_X, TILT_Y, YAW) if turns else (X, Y, Z)
        must_stay = press_n > 0 and until is None
        press = giving_way(self._loop, push, axes, contact_must_stay=must_stay)
        return await self._hold(MotionKind.COMPLY, press, hold_s, until)

    async def feed(
        self,
        depth_m: float,
        force_limit_n: float,
        until: Condition | None = None,
        past_m: float = 0.0,
    ) -> ContactMotion:
        """See ``ContactMotions``; ends by ``FORCE`` when the force has stopped the feed."""
        self._pressed_n = 0.0
        target = self._loop.tip_command.copy()
        target[2] = max(target[2], depth_m + past_m)
        path = self._path(*straight(self._loop.tip_command, target, _TURN_LEVER_M))
        feed = FeedRule(self._settings.figures, force_limit_n, depth_m, self._loop.period_s)
        press = giving_way(
            self._loop, np.zeros(6), (X, Y, TILT_X, TILT_Y), spring=self._settings.springs
        )
        end = first_of(when(until), feed.stalled, arrived(path))
        return await self._run(
            MotionKind.FEED, path, feed.speed_m_s, end, feed.slowest_m_s, press=press
        )

    async def back_out(self, height_m: float) -> ContactMotion:
        """See ``ContactMotions``; ends by ``FORCE`` when something holds the peg back."""
        self._pressed_n = 0.0
        points = self._loop.trail.out(self._loop.tip_command, height_m)
        lengths = np.linalg.norm(np.diff(points[:, :3], axis=0), axis=1)
        path = self._path(points, lengths)
        settings = self._settings
        slow = min(settings.touch_speed_m_s, fastest_m_s(self._loop))
        fast = min(settings.fastest_retreat_m_s, fastest_m_s(self._loop))

        def speed(sample: ContactSample) -> float:
            in_contact_n = max(_IN_CONTACT_N, 4.0 * sample.force_sigma_n)
            return slow if float(np.linalg.norm(sample.force_n)) > in_contact_n else fast

        def held(sample: ContactSample) -> Ended | None:
            pulled = float(sample.force_n[2]) > _PULL_RATIO * settings.press_n
            return Ended.FORCE if pulled else None

        return await self._run(
            MotionKind.BACK_OUT, path, speed, first_of(held, arrived(path)), slow
        )

    async def hold_while(self, work: Coroutine[Any, Any, None], *, limit_s: float = HOLD_S) -> None:
        """See ``standing.hold_while``."""
        await hold_while(self._loop, work, limit_s)

    def _press_along(self, force_n: float, *, contact_must_stay: bool = False) -> Press:
        push = np.array([0.0, 0.0, force_n, 0.0, 0.0, 0.0])
        return giving_way(self._loop, push, (Z,), contact_must_stay=contact_must_stay)

    def _path(
        self, points: Array, lengths: Array, acceleration: float | None = None
    ) -> PathFollower:
        most = acceleration or self._settings.acceleration_m_s2
        return PathFollower(points, lengths, most, self._loop.period_s)

    async def _hold(
        self, kind: MotionKind, press: Press, hold_s: float, until: Condition | None
    ) -> ContactMotion:
        self._loop.begin_motion(kind)
        here = self._loop.tip_command
        path = self._path(np.stack([here, here]), np.zeros(1))
        end = when(until)
        return await StreamedMotion(self._loop, path, lambda _sample: 0.0, end, hold_s, press).run()

    async def _run(
        self,
        kind: MotionKind,
        path: PathFollower,
        speed: Callable[[ContactSample], float],
        end: End,
        slowest: float,
        *,
        press: Press | None = None,
    ) -> ContactMotion:
        self._loop.begin_motion(kind)
        way = max(path.remaining, _SHORTEST_M)
        limit_s = _LATEST_S + _LATEST_RATIO * way / slowest
        motion = await StreamedMotion(self._loop, path, speed, end, limit_s, press).run()
        if motion.ended is Ended.TIME:
            # A fault of the stream and no end of the motion: late ticks have kept the arm from
            # moving, so the place that it has come to says nothing about the part.
            depth_mm = float(motion.last.task_position_tip_m[2]) / MM
            raise StreamLate(
                f"{kind.value} was given up after {limit_s:.1f} s with {path.remaining / way:.0%} "
                f"of its way left, the tip at a depth of {depth_mm:.1f} mm"
            )
        return motion
