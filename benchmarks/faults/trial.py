"""One cell of the matrix: into the phase, the fault, what follows, and back to Idle."""

import time
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from benchmarks.faults.bench import LINE_FAILURES, POLL_S, RESTING, Bench, NotReached
from benchmarks.faults.kinds import Fault, demanded
from benchmarks.faults.line import Shown
from benchmarks.faults.observation import Expected, Moved, Observation
from benchmarks.faults.phases import PRODUCTION, Phase, start_run
from fakes.demo.control import Refused

QUIET_S = 2.0
"""So long the arms are watched after the end: a motion that begins by itself would be seen."""
STANDS_S = 2.5
"""An arm that has not moved for so long stands, while the line sees nothing."""


def run_trial(bench: Bench, fault: Fault, phase: Phase) -> Observation:
    """Try one fault in one phase; raises ``NotReached``."""
    bench.control.request("watch_begin")
    arm = phase.reach(bench)
    bench.fresh = False
    before, truth = bench.newest_run()[0] if phase.starts else 0, bench.truth()
    bench.control.request("reset_peak")
    known = set(bench.plc.shown().alarms)
    bench.control.request("watch_begin")
    fault.begin(bench, arm)
    refused = _start(bench) if phase.starts else 0
    ended_s, last = _until_it_ends(bench, fault)
    alarms = _alarms(bench, last, known)
    _quiet(bench)
    watched, after = bench.watched(), bench.truth()
    record = _record(bench, fault, phase, before)
    next_start, idle_again = _next_start(bench, fault)
    alarms |= _alarms(bench, bench.shown(), known) if fault.line_silent else set()
    _tidy(bench)
    effect, bound_s = demanded(fault, phase)
    return Observation(
        fault=fault.key,
        phase=phase.key,
        expected=Expected(effect, bound_s, phase.peak_bound_n, fault.line_silent, phase.has_record),
        motions=_motions(watched),
        peak_n=after["peak_contact_force_n"],
        ended_s=ended_s,
        state=last.state if last is not None else "silent",
        shown=sorted(alarms),
        refused=refused,
        record=record,
        next_start=next_start,
        idle_again=idle_again,
        lost_s=after["lost_s"] - truth["lost_s"],
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


def _record(bench: Bench, fault: Fault, phase: Phase, before: int) -> str | None:
    """How the newest record ended; a killed daemon closes its own at its next start."""
    if fault.line_silent or not phase.has_record:
        return None
    number, result = bench.newest_run()
    return (result or "open") if number > before else None


def _next_start(bench: Bench, fault: Fault) -> tuple[str, bool]:
    """Fault away, Clear, Reset; a daemon that does not come back by them is started again."""
    words = []
    bench.clear_faults()
    with suppress(NotReached, *LINE_FAILURES):
        if not fault.line_silent:
            bench.plc.__exit__(None, None, None)
            bench.connect_plc()
            return bench.to_idle(PRODUCTION), True
    try:
        words.append("daemon started again:")
        bench.restart_daemon()
        words.append(bench.to_idle(PRODUCTION))
    except (NotReached, *LINE_FAILURES) as error:
        return f"{' '.join(words)} {str(error)[:120]}", False
    return " ".join(words), True


def _tidy(bench: Bench) -> None:
    """As an operator leaves the cell for the next job; what fails is found by the next trial."""
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
        )
        for arm, motions in watched["motions"].items()
        for motion in motions
    ]
