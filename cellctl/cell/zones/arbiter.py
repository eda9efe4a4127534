"""Grants zones to one arm at a time, by where the robots report their arms to be."""

import asyncio
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, field, replace

from cellctl import log
from cellctl.cell.zones.ways import Way
from cellctl.cell.zones.zone import Zone
from cellctl.clock import Monotonic, now_s
from cellctl.errors import CellError
from cellctl.errors.robot import ZoneTaken
from cellctl.interfaces import RobotState

_log = log.get(__name__)

REPORT_AGE_S = 0.5
"""A position older than this is not known. Controllers report every 20 ms, so that 25 reports in a
row are missing by then."""
REPORT_WAIT_S = 1.0
"""How long a report may stay away, or an arm take to come to rest, before a zone is refused."""
POLL_S = 0.05
"""Pause between two looks at a zone that is taken: what it adds to a wait is not noticed."""


@dataclass(frozen=True, slots=True, eq=False)
class _Passage:
    """A move that is under way."""

    robot: str
    way: Way


@dataclass(frozen=True, slots=True)
class _Claim:
    """Why a zone is not free."""

    zone: str
    robot: str
    reason: str
    patience_s: float
    """How long it is worth waiting: 0 for an arm that stays."""
    detail: str = field(default="", compare=False)
    """Differs from look to look, such as the age of a report; it is the same claim all the same."""
    rests: bool = False
    """The arm stands in the zone, and reports it."""

    def __str__(self) -> str:
        return f"{self.zone}: {self.robot} {self.reason}" + (self.detail and f" ({self.detail})")


class ZoneArbiter:
    """Decides for each move of a robot whether the zones on its way are free.

    A zone is taken by an arm that is under way through it, by one that reports a place in it, and
    by one of which nobody knows where it is. Nothing of this is remembered over a restart: the
    reports say it. Belongs to one event loop, which also makes a grant one step: between the look
    at the other arms and the grant nothing else runs.
    """

    def __init__(
        self,
        zones: Sequence[Zone],
        states: Mapping[str, Callable[[float], RobotState]],
        *,
        clock: Monotonic = now_s,
    ) -> None:
        """``states`` by robot: the newest report; raises a ``CellError`` beyond an age in s."""
        self._zones, self._states, self._now_s = zones, states, clock
        self._longest_wait_s = REPORT_WAIT_S + max((zone.wait_s for zone in zones), default=0.0)
        self._under_way: list[_Passage] = []
        self._ended_s: dict[str, float] = {}
        """When the last move of a robot ended, however it did."""

    @asynccontextmanager
    async def passage(self, robot: str, plan: Callable[[], Way]) -> AsyncIterator[None]:
        """Hold the zones that a move needs, for as long as the context lasts.

        ``plan`` gives the way from where the arm is now; it is asked again while the robot waits.
        Waits for an arm that is on its way out, up to the zone's ``wait_s``. Raises ``ZoneTaken``
        when another arm stays in the zone or its place is not known, before anything moves, and
        what ``plan`` raises.
        """
        passage = _Passage(robot, await self._granted_way(robot, plan))
        # The loop has had no turn since the last look at the other arms: whoever asks next finds
        # this move.
        self._under_way.append(passage)
        try:
            yield
        finally:
            self._under_way.remove(passage)
            # However it ended: until a newer report the arm may be anywhere on its way.
            self._ended_s[robot] = self._now_s()

    async def _granted_way(self, robot: str, plan: Callable[[], Way]) -> Way:
        since_s: dict[_Claim, float] = {}
        begin_s = self._now_s()
        while claims := self._claims(robot, way := plan()):
            time_s = self._now_s()
            if not since_s:
                _log.info("zone is not free", robot=robot, claims=[str(one) for one in claims])
            # Counted for each claim by itself: an arm that was long on its way out has still the
            # time of a report to say that it is out.
            since_s = {claim: since_s.get(claim, time_s) for claim in claims}
            # Arms that come and go may make a new claim each time, so the whole wait has an end.
            late = time_s - begin_s > self._longest_wait_s
            lasting = [one for one in claims if late or time_s - since_s[one] >= one.patience_s]
            if lasting:
                reasons = "; ".join(str(one) for one in lasting)
                raise ZoneTaken(f"{robot} needs the zone and was not moved. {reasons}")
            await asyncio.sleep(POLL_S)
        return way

    def _claims(self, robot: str, way: Way) -> list[_Claim]:
        return [
            claim
            for zone in self._zones
            if robot in zone.shares and way.needs(zone.shares[robot])
            for other in zone.shares
            if other != robot and (claim := self._claim_on(zone, other, robot, way)) is not None
        ]

    def _claim_on(self, zone: Zone, other: str, robot: str, way: Way) -> _Claim | None:
        """What forbids a robot its way because of another one."""
        claim = self._claim(zone, other)
        # Two in one zone, as after an abort: they leave one after the other in the stated order.
        if claim is None or not claim.rests or not way.leads_out(zone.shares[robot]):
            return claim
        if zone.leaves_before(robot, other):
            return None
        if zone.leaves_before(other, robot):
            return replace(claim, reason="stands in it and leaves first", patience_s=zone.wait_s)
        return claim

    def _claim(self, zone: Zone, robot: str) -> _Claim | None:
        share = zone.shares[robot]
        moves = [passage.way for passage in self._under_way if passage.robot == robot]
        through = [way for way in moves if way.needs(share)]
        if any(way.ends_in(share) for way in through):
            return _Claim(zone.name, robot, "is on its way into it", 0.0)
        if through:
            return _Claim(zone.name, robot, "is on its way out of it", zone.wait_s)
        return self._reported_claim(zone, robot, under_way=bool(moves))

    def _reported_claim(self, zone: Zone, robot: str, *, under_way: bool) -> _Claim | None:
        try:
            state = self._states[robot](REPORT_AGE_S)
        except CellError as fault:
            reason = "may be in it: its place is not known"
            return _Claim(zone.name, robot, reason, REPORT_WAIT_S, str(fault))
        if zone.shares[robot].box.holds(state.base_T_flange.translation):
            still = (
                not under_way and not state.moving and self._reported_since_its_move(robot, state)
            )
            return _Claim(zone.name, robot, "stands in it", 0.0, rests=still)
        if under_way:
            return None
        if not self._reported_since_its_move(robot, state):
            reason = "may be in it: it has not reported its place since its last move"
            return _Claim(zone.name, robot, reason, REPORT_WAIT_S)
        # Jogged from its panel, or still braking after a stop.
        if state.moving:
            return _Claim(zone.name, robot, "moves without a command of this PC", REPORT_WAIT_S)
        return None

    def _reported_since_its_move(self, robot: str, state: RobotState) -> bool:
        """The end of a move is known earlier than the report of where it ended."""
        return state.time_s > self._ended_s.get(robot, -float("inf"))
