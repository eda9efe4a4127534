"""Feeds a peg that has entered to its seat.

A retry never raises a limit. Source: sections 4.4, 5.2 and 5.3 of the study of insertion by touch.
"""

from dataclasses import dataclass

from cellctl.cell.contact_motion.motions import (
    ContactMotion,
    ContactMotions,
    ContactSample,
    Ended,
    never,
)
from cellctl.processes.peg_in_hole.faults import (
    ForceActsWithFeed,
    ForceDropped,
    HoleBlocked,
    NotSeated,
    PegJammed,
    PegNotInserted,
    PegSlipped,
    PegWedged,
    SensorDead,
)
from cellctl.processes.peg_in_hole.insertion.felt import (
    Standing,
    greatest_axial_n,
    seat_slope_n_m,
    unloaded_depth_m,
)
from cellctl.processes.peg_in_hole.insertion.keyway import find_keyway
from cellctl.processes.peg_in_hole.insertion.past_seat import SEAT_TOLERANCE_M, PastSeat
from cellctl.processes.peg_in_hole.insertion.recovery import IN_ORDER, WHEN_STRAIGHT, Recovery
from cellctl.processes.peg_in_hole.insertion.resistance import held_way_m, unrubbed_way_m
from cellctl.processes.peg_in_hole.insertion.with_feed import ForceWithFeed, with_feed_n
from cellctl.processes.peg_in_hole.insertion.zero_jump import ZeroJump, dropped_n
from cellctl.processes.peg_in_hole.plan.task import SearchTask
from cellctl.processes.peg_in_hole.verdict.lateral import walls_answer

_MOST_RECOVERIES, _RECOVERY_S = 3, 15.0
"""Recoveries in all, and the time for them from the end of the first feed on (section 5.3)."""
_GAIN_M = 0.2e-3
"""Depth that a recovery has to win."""
_SAME_DEPTH_M = 0.1e-3
"""Two feeds that end no farther apart than this have met the same thing."""
_ASKED_BEFORE_M = 0.5e-3
"""How far before the seat the arm asks whether the sensor still answers: farther than the seat may
lie higher than drawn."""


@dataclass(frozen=True, slots=True)
class Fed:
    """An insertion that has come to the depth of the seat."""

    depth_m: float
    """Depth of the tip below the face, less what arm and contact yield under the force."""
    seat_force_n: float
    seat_slope_n_m: float | None
    held_way_m: float
    """Way on which something held the peg back in the last feed; see ``held_way_m``."""
    unrubbed_way_m: float | None
    """Way without the force of the contacts in the last feed; None for a part without contacts."""
    with_feed_n: float
    """Greatest force that acted with the last feed."""
    dropped_n: float
    """Greatest drop of the force in the last feed that no way back explains."""
    greatest_force_n: float
    recoveries: tuple[str, ...]
    samples: tuple[ContactSample, ...]


async def insert(motions: ContactMotions, task: SearchTask, face_yields_m: float) -> Fed:
    """Feed the peg to its seat, with at most three recoveries that each have to gain depth.

    Arm and face had yielded by ``face_yields_m`` under the touches of the face, so frame A lies
    deeper than the free face by that. Raises ``KeywayNotFound``, ``PegJammed``, ``PegWedged`` or
    ``HoleBlocked`` with the figures where the peg stands, ``NotSeated`` where no seat stops it,
    ``ForceActsWithFeed`` or ``ForceDropped``, and ``SensorDead`` where it does not feel the walls.
    """
    if task.fit.keys is not None:
        await find_keyway(motions, task, task.fit.keys)
    feed = _Feed(motions, task, face_yields_m)
    motion = await feed.on()
    helped: list[str] = []
    begun_s = motion.last.time_s
    while motion.ended is Ended.FORCE and feed.short_of_seat(motion):
        standing = Standing.of(motion.last)
        measures = IN_ORDER if standing.sideways else WHEN_STRAIGHT
        left = [one for one in measures if one.name not in helped]
        late = motion.last.time_s - begun_s > _RECOVERY_S
        if not left or len(helped) >= _MOST_RECOVERIES or late:
            raise PegJammed(f"{standing}; tried: {', '.join(helped) or 'nothing'}")
        await _help(motions, task, standing, left[0])
        helped.append(left[0].name)
        motion = await feed.on()
        _require_gain(standing, Standing.of(motion.last), helped)
    if motion.ended is not Ended.FORCE:
        # A deeper hole, or a sensor that feels nothing any more: pushes to the sides and a press
        # would then go on with whatever force the arm has.
        raise NotSeated(f"nothing has stopped the feed: {Standing.of(motion.last)}")
    return feed.result(motion, tuple(helped))


class _Feed:
    """Feeds, and keeps every sample."""

    def __init__(self, motions: ContactMotions, task: SearchTask, face_yields_m: float) -> None:
        self._motions, self._task, self._face_yields_m = motions, task, face_yields_m
        self._samples: list[ContactSample] = []
        # The feed goes on beyond the drawn seat until a force ends it. With a dead sensor no force
        # does, and on a stiff arm that way alone makes more force than the insertion may take.
        dead_n = task.cell.stiffness_n_m * SEAT_TOLERANCE_M
        self._to_be_asked = dead_n > task.limits.insertion_n
        """Whether the sensor has to show before the seat that it still answers."""

    async def on(self) -> ContactMotion:
        """Feed to a little beyond the seat, so that only a force can end the feed at it."""
        seat_m, limits, cell = self._task.fit.depth_m, self._task.limits, self._task.cell
        past_m = limits.insertion_n / cell.stiffness_n_m + SEAT_TOLERANCE_M
        if not self._to_be_asked:
            return await self._to(seat_m, past_m)
        before = await self._to(seat_m - _ASKED_BEFORE_M)
        if before.ended is not Ended.TRAVEL:
            return before
        self._to_be_asked = False
        if not await walls_answer(self._motions, self._task):
            raise SensorDead(f"no wall was felt before the seat: {Standing.of(before.last)}")
        rest = await self._to(seat_m, past_m)
        return ContactMotion(rest.ended, (*before.samples, *rest.samples))

    async def _to(self, depth_m: float, past_m: float = 0.0) -> ContactMotion:
        limit_n = self._task.limits.insertion_n
        watched, jump = ForceWithFeed(self._task.cell), ZeroJump(self._task)
        past_seat = PastSeat(self._task, self._face_yields_m)
        ended_by: list[bool] = []

        def wrong(sample: ContactSample) -> bool:
            # Each takes every sample.
            ended_by[:] = (watched.take(sample), jump.take(sample), past_seat.take(sample))
            return any(ended_by)

        motion = await self._motions.feed(depth_m, limit_n, wrong, past_m)
        self._samples += motion.samples
        if motion.ended is Ended.CONDITION:
            raise self._fault(Standing.of(motion.last), ended_by, watched, jump, past_seat)
        return motion

    @staticmethod
    def _fault(
        standing: Standing,
        ended_by: list[bool],
        watched: ForceWithFeed,
        jump: ZeroJump,
        past_seat: PastSeat,
    ) -> PegNotInserted:
        with_feed, dropped, _ = ended_by
        if with_feed:
            return ForceActsWithFeed(f"{watched.greatest_n:.1f} N into the hole: {standing}")
        if dropped:
            return ForceDropped(f"by {jump.dropped_n:.1f} N: {standing}")
        if past_seat.held:
            return PegSlipped(f"the force does not rise at the seat: {standing}")
        return NotSeated(f"nothing has stopped the feed at the seat: {standing}")

    def short_of_seat(self, motion: ContactMotion) -> bool:
        """Whether a feed that a force has ended is not at the seat."""
        reached_m = self._unloaded_m(Standing.of(motion.last))
        return reached_m < self._task.fit.depth_m - SEAT_TOLERANCE_M

    def _unloaded_m(self, standing: Standing) -> float:
        return unloaded_depth_m(standing, self._task.cell.stiffness_n_m, self._face_yields_m)

    def result(self, motion: ContactMotion, recoveries: tuple[str, ...]) -> Fed:
        """What is known at the end of the last feed."""
        end, fit, cell = Standing.of(motion.last), self._task.fit, self._task.cell
        return Fed(
            depth_m=self._unloaded_m(end),
            seat_force_n=end.axial_n,
            seat_slope_n_m=seat_slope_n_m(motion.samples),
            held_way_m=held_way_m(motion.samples, fit, cell.friction, cell.stiffness_n_m),
            unrubbed_way_m=unrubbed_way_m(motion.samples, fit, cell.stiffness_n_m),
            with_feed_n=with_feed_n(motion.samples, cell),
            dropped_n=dropped_n(motion.samples, self._task),
            greatest_force_n=greatest_axial_n(self._samples),
            recoveries=recoveries,
            samples=tuple(self._samples),
        )


async def _help(
    motions: ContactMotions, task: SearchTask, standing: Standing, measure: Recovery
) -> None:
    """Apply one recovery. Raises ``PegWedged`` instead where the peg is wedged: whatever pushes or
    pulls harder would only break the part.
    """
    # The test of a wedge: the feed is lowered, and side force and moment do not follow it.
    lowered = await motions.press(0.3 * standing.axial_n, 0.2, never)
    if Standing.of(lowered.last).wedged_after(standing):
        raise PegWedged(str(standing))
    await measure.apply(motions, task.fit, standing)


def _require_gain(before: Standing, after: Standing, helped: list[str]) -> None:
    gained_m = after.depth_m - before.depth_m
    if gained_m >= _GAIN_M:
        return
    if abs(gained_m) < _SAME_DEPTH_M and not after.sideways and not before.sideways:
        raise HoleBlocked(f"{after}, the same after a second entry")
    if len(helped) >= _MOST_RECOVERIES:
        raise PegJammed(f"{after}; tried: {', '.join(helped)}")
