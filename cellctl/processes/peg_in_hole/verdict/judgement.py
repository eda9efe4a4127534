"""The verdict: a peg is inserted only when every item of evidence says so.

Depth alone accepts every peg that has slipped in the gripper; the lateral test alone accepts some
that stand on the face and some in a larger hole. Source: section 5.4 of the study of insertion by
touch.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import isnan, nan
from typing import Any

from cellctl.calibration.checks import Checks, LimitCheck
from cellctl.processes.peg_in_hole.faults import (
    FalseSeat,
    ForceActsWithFeed,
    ForceDropped,
    HoleTooWide,
    NotSeated,
    PegNotHeld,
    PegNotInserted,
    PegSlipped,
    SensorDead,
)
from cellctl.processes.peg_in_hole.insertion.felt import LEAST_SLOPE
from cellctl.processes.peg_in_hole.insertion.with_feed import most_with_feed_n
from cellctl.processes.peg_in_hole.insertion.zero_jump import most_dropped_n
from cellctl.processes.peg_in_hole.verdict.evidence import InsertionEvidence, LateralCapture
from cellctl.processes.peg_in_hole.verdict.judged_task import JudgedTask

_MM = 1e-3
# Items 1, 7, 5 and 4 of section 5.4.
_SEAT_MM, _RETOUCH_MM, _STEADY_MM, _PLAY_MM = 0.3, 0.15, 0.1, 0.1
HELD_MM = 0.2
"""A part that has slipped by more is told from one that has not (peg_slip of section 5.2)."""
_LEAST_SIGMAS = 5.0
"""By so many standard deviations a living sensor's force changes at least between two pushes."""
MOST_OF_GRIP = 0.6
"""Greatest force over that at which the part slips; the limit of an insertion is to be set to no
more (section 4.5)."""

DEPTH, LOW_FORCE, HIGH_FORCE = "distance from the seat", "seat force", "greatest seat force"
SLOPE = "rise of the force at the seat"
RESISTED, PLAY_X, PLAY_Y = "directions that resist", "play along x", "play along y"
STEADY, ALIVE = "depth change when pushed sideways", "force change when pushed sideways"
HELD, WITH_FEED = "way held back before the seat", "force with the feed"
DROPPED = "drop of the force in the feed"
UNRUBBED = "way without the force of its contacts"
SLIP, RETOUCH = "greatest force over grip force", "error of the touch on the rear"
KEYED, PULL = "directions that resist a turn", "pull that was held"

_SEAT = frozenset({DEPTH, LOW_FORCE, HIGH_FORCE, SLOPE})
_FAULTS: tuple[tuple[frozenset[str], type[PegNotInserted]], ...] = (
    # The first that fits: what makes other figures worthless comes first. A peg on the face hardly
    # resists a push, which looks like a dead sensor too; hence slip before that. A sensor that
    # stays at a value looks like a part that is held back.
    (frozenset({WITH_FEED}), ForceActsWithFeed),
    (frozenset({DROPPED}), ForceDropped),
    (frozenset({SLIP, RETOUCH}), PegSlipped),
    (frozenset({ALIVE}), SensorDead),
    (frozenset({HELD, UNRUBBED}), PegSlipped),
    (_SEAT, NotSeated),
    (frozenset({RESISTED, STEADY}), FalseSeat),
    (frozenset({PLAY_X, PLAY_Y}), HoleTooWide),
    (frozenset({KEYED, PULL}), PegNotHeld),
)


class PegVerdict(StrEnum):
    """What the figures say of a peg. Only the first lets a part pass."""

    INSERTED = "inserted"
    NOT_INSERTED = "not inserted"
    UNKNOWN = "unknown"
    """No figure speaks against it, but at least one is missing."""


@dataclass(frozen=True, slots=True)
class PegSeatLimits:
    """What a good part feels like at its seat, from its recipe."""

    least_n: float
    most_n: float
    keyed: bool = False
    pull_n: float | None = None
    """None for a part that nothing holds."""


@dataclass(frozen=True, slots=True)
class PegJudgement:
    """The verdict with every figure that led to it."""

    checks: Checks

    @property
    def inserted(self) -> bool:
        """All items hold; an unknown one does not."""
        return all(check.passed for check in self.checks)

    @property
    def verdict(self) -> PegVerdict:
        """Which of the three; a figure beyond its limit weighs more than one that is missing."""
        failed = [check for check in self.checks if not check.passed]
        if not failed:
            return PegVerdict.INSERTED
        missing = all(isnan(check.value) for check in failed)
        return PegVerdict.UNKNOWN if missing else PegVerdict.NOT_INSERTED

    @property
    def fault(self) -> PegNotInserted | None:
        """The numbered fault; None for a peg that is inserted."""
        failed = {check.name for check in self.checks if not check.passed}
        unpushed = {check.name for check in self.checks if isnan(check.value)} & {ALIVE}
        if failed & _SEAT:
            # A sensor is not dead because nobody has pushed; where the peg stands says more.
            failed -= unpushed
        words = "; ".join(str(check) for check in self.checks if not check.passed)
        for names, fault in _FAULTS:
            if failed & names:
                return fault(words)
        return None

    def to_record(self) -> Mapping[str, Any]:
        """Plain data."""
        fault = self.fault
        return {
            "inserted": self.inserted,
            "verdict": self.verdict.value,
            "fault": None if fault is None else fault.number,
            "checks": [check.to_record() for check in self.checks],
        }


def judge_peg(evidence: InsertionEvidence, task: JudgedTask, seat: PegSeatLimits) -> PegJudgement:
    """All items of section 5.4."""
    return PegJudgement(
        (
            *_seat_checks(evidence, task, seat),
            *_feed_checks(evidence, task),
            *_capture_checks(evidence.capture, task),
            _slip_check(evidence),
            *_holding_checks(evidence, seat),
        )
    )


def _seat_checks(evidence: InsertionEvidence, task: JudgedTask, seat: PegSeatLimits) -> Checks:
    depth_m = _known(evidence.depth_m)
    force_n, slope = _known(evidence.seat_force_n), _known(evidence.seat_slope_n_m)
    least_slope = LEAST_SLOPE * task.cell.stiffness_n_m
    return (
        LimitCheck(DEPTH, abs(depth_m - task.fit.depth_m) / _MM, _SEAT_MM, "mm"),
        LimitCheck(LOW_FORCE, force_n, seat.least_n, "N", "min"),
        LimitCheck(HIGH_FORCE, force_n, seat.most_n, "N"),
        LimitCheck(SLOPE, slope * _MM, least_slope * _MM, "N/mm", "min"),
    )


def _feed_checks(evidence: InsertionEvidence, task: JudgedTask) -> Checks:
    checks = [
        LimitCheck(HELD, _known(evidence.held_way_m) / _MM, HELD_MM, "mm"),
        LimitCheck(WITH_FEED, _known(evidence.with_feed_n), most_with_feed_n(task.cell), "N"),
        LimitCheck(DROPPED, _known(evidence.dropped_n), most_dropped_n(task.cell), "N"),
    ]
    if task.fit.contacts is not None:
        unrubbed_mm = _known(evidence.unrubbed_way_m) / _MM
        checks.append(LimitCheck(UNRUBBED, unrubbed_mm, HELD_MM, "mm"))
    return tuple(checks)


def _capture_checks(capture: LateralCapture | None, task: JudgedTask) -> Checks:
    most_mm = 2 * task.fit.clearance_m / _MM + _PLAY_MM
    # Never pushed: no figure is known.
    found = capture or LateralCapture(None, None, None, nan, nan)
    return (
        LimitCheck(RESISTED, _known(found.resisted), 4, "", "min"),
        LimitCheck(PLAY_X, _known(found.play_x_m) / _MM, most_mm, "mm"),
        LimitCheck(PLAY_Y, _known(found.play_y_m) / _MM, most_mm, "mm"),
        LimitCheck(STEADY, found.depth_change_m / _MM, _STEADY_MM, "mm"),
        LimitCheck(ALIVE, found.force_change_sigmas, _LEAST_SIGMAS, "σ", "min"),
    )


def _slip_check(evidence: InsertionEvidence) -> LimitCheck:
    """Either no force could make the part slip, or a touch shows that it did not."""
    # A grip force of 0 is as unknown as none: no number, so that the check fails.
    ratio = _known(evidence.greatest_force_n) / (evidence.grip_force_n or nan)
    by_force = LimitCheck(SLIP, ratio, MOST_OF_GRIP, "")
    if by_force.passed or isnan(ratio):
        return by_force
    return LimitCheck(RETOUCH, abs(_known(evidence.retouch_error_m)) / _MM, _RETOUCH_MM, "mm")


def _holding_checks(evidence: InsertionEvidence, seat: PegSeatLimits) -> Checks:
    checks: list[LimitCheck] = []
    if seat.keyed:
        checks.append(LimitCheck(KEYED, _known(evidence.keyed_directions), 2, "", "min"))
    if seat.pull_n is not None:
        checks.append(LimitCheck(PULL, _known(evidence.held_pull_n), seat.pull_n, "N", "min"))
    return tuple(checks)


def _known(value: float | None) -> float:
    """An unknown figure is no number, and no limit holds for that."""
    return nan if value is None else value
