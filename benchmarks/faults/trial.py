"""One cell of the matrix: into the phase, the fault, what follows, and back to Idle."""

import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from benchmarks.faults.bench import LINE_FAILURES, POLL_S, RESTING, Bench, NotReached
from benchmarks.faults.kinds import Fault, demanded
from benchmarks.faults.line import Shown
from benchmarks.faults.observation import Effect, Expected, Moved, Observation
from benchmarks.faults.phases import LIMIT_N, PRODUCTION, Phase, start_run
from cellctl.version import software
from fakes.demo.control import Refused

QUIET_S = 2.0
"""Time for which the arms are watched after the end, to see a motion that begins by itself."""
STANDS_S = 2.5
"""An arm that has not moved for so long stands, while the line sees nothing."""


@dataclass(frozen=True, slots=True)
class _Found:
    """What the next start found, in words, and how it ended."""

    words: str
    idle: bool
    restarted: bool


def run_trial(bench: Bench, fault: Fault, phase: Phase) -> Observation:
    """Try one fault in one phase; raises ``NotReached``."""
    before = bench.newest_run()[0]
    bench.control.request("watch_begin")
    arm = phase.reach(bench)
    bench.fresh = False
    truth = bench.truth()
    bench.control.request("reset_peak")
    known = set(bench.plc.shown().alarms)
    bench.control.request("watch_begin")
    fault.begin(bench, arm)
    refused = _start(bench) if phase.starts else 0
    ended_s, last = _until_it_ends(bench, fault)
    alarms = _alarms(bench, last, known)
    _quiet(bench)
    watched, after = bench.watched(), bench.truth()
    record = _record(bench, before)
    found = _next_start(bench, fault)
    if found.restarted or (last is not None and last.state == "Held"):
        # The next start of the daemon closes the record, and so does the Stop of a held run.
        record = _record(bench, before)
    if fault.line_silent:
        alarms |= _alarms(bench, bench.shown(), known)
    _tidy(bench)
    return Observation(
        fault=fault.key,
        phase=phase.key,
        expected=_expected(fault, phase),
        motions=_motions(watched),
        peak_n=after["peak_contact_force_n"],
        ended_s=ended_s,
        state=last.state if last is not None else "silent",
        shown=sorted(alarms),
        refused=refused,
        record=record,
        next_start=found.words,
        idle_again=found.idle,
        restarted=found.restarted,
        calibrated=found.idle and bench.plc.bit("calibration_ok"),
        lost_s=after["lost_s"] - truth["lost_s"],
        software=software(),
    )


def _expected(fault: Fault, phase: Phase) -> Expected:
    effect, bound_s = demanded(fault, phase)
    # A daemon that is killed or held as Start comes may not have begun a run.
    unheard = fault.line_silent or fault.silent_s > 0
    has_record = phase.has_record and not (phase.starts and unheard)
    return Expected(
        effect,
        bound_s,
        # A job that need not end at once may go on into the contact that its recipe plans.
        LIMIT_N if effect is Effect.AT_NEXT_USE else phase.peak_bound_n,
        line_silent=fault.line_silent,
        may_restart=fault.may_restart,
        noticed_s=fault.noticed_s,
        has_record=has_record,
    )


def _start(bench: Bench) -> int:
    """The reject code of a Start beside the fault."""
    try:
        start_run(bench)
    except NotReached:
        return bench.plc.value("reject_code")
    except LINE_FAILURES:
        return 0  # the daemon is silent: nothing was taken
    return 0


def _until_it_ends(bench: Bench, fault: Fault) -> tuple[float | None, Shown | None]:
    """When the line saw a state of rest, and what it saw last."""
    begun_s, last = time.monotonic(), None
    resume = fault.resume
    while (passed_s := time.monotonic() - begun_s) < fault.patience_s:
        if resume is not None and passed_s > fault.silent_s:
            resume(bench)
            resume = None
        silent = fault.line_silent or resume is not None
        if not silent and (shown := bench.shown()) is not None:
            last = shown
            if shown.state in RESTING:
                return bench.watched()["watched_s"], shown
        if fault.line_silent and _stands(bench.watched()):
            return None, None
        time.sleep(POLL_S)
    return None, last


def _stands(watched: Mapping[str, Any]) -> bool:
    ends = [motion["ended_s"] for motions in watched["motions"].values() for motion in motions[-1:]]
    return None not in ends and watched["watched_s"] > max(ends, default=0.0) + STANDS_S


def _quiet(bench: Bench) -> None:
    """Let time of the world pass, in which nothing may begin to move."""
    until_s = bench.watched()["watched_s"] + QUIET_S
    while bench.watched()["watched_s"] < until_s:
        time.sleep(POLL_S)


def _alarms(bench: Bench, last: Shown | None, known: set[int]) -> set[int]:
    if last is None:
        return set()
    shown = bench.shown() or last
    return ({last.first_out, shown.first_out} - {0}) | (set(shown.alarms) - known)


def _record(bench: Bench, before: int) -> str | None:
    """How the record of the job ended; none where the newest one is an earlier job's."""
    number, result = bench.newest_run()
    return (result or "open") if number > before else None


def _next_start(bench: Bench, fault: Fault) -> _Found:
    """Fault away, Clear, Reset; a daemon that does not come back by them is started again."""
    words: list[str] = []
    bench.clear_faults()
    if not fault.line_silent:
        try:
            bench.plc.__exit__(None, None, None)
            bench.connect_plc()
            return _Found(bench.to_idle(PRODUCTION), idle=True, restarted=False)
        except (NotReached, *LINE_FAILURES) as error:
            words.append(f"{str(error)[:120]};")
    words.append("daemon started again:")
    try:
        bench.restart_daemon()
        words.append(bench.to_idle(PRODUCTION))
    except (NotReached, *LINE_FAILURES) as error:
        return _Found(f"{' '.join(words)} {str(error)[:120]}", idle=False, restarted=True)
    return _Found(" ".join(words), idle=True, restarted=True)


def _tidy(bench: Bench) -> None:
    """Tidy up as an operator does for the next job; what fails is found by the next trial."""
    with suppress(Refused, NotReached, *LINE_FAILURES):
        bench.acknowledge()
        bench.next_parts()


def _motions(watched: Mapping[str, Any]) -> list[Moved]:
    return [
        Moved(
            arm,
            motion["begun_s"],
            motion["ended_s"],
            motion["travel_mm"],
            motion["rise_mm"],
            motion["turn_deg"],
        )
        for arm, motions in watched["motions"].items()
        for motion in motions
    ]
