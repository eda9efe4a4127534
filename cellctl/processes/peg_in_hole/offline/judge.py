"""The judge of `cellctl judge-insertion --task`."""

from math import isfinite
from pathlib import Path
from typing import Any

from cellctl.calibration.judged_insertion import JudgedInsertion
from cellctl.processes.peg_in_hole.faults import PegCurveInvalid
from cellctl.processes.peg_in_hole.offline.curve import PegCurve, read_curve
from cellctl.processes.peg_in_hole.offline.evidence import evidence_of
from cellctl.processes.peg_in_hole.offline.own_curve import require_own_curve
from cellctl.processes.peg_in_hole.offline.task_file import (
    JudgedPart,
    TaskOfCurve,
    read_part,
    recorded_evidence,
)
from cellctl.processes.peg_in_hole.offline.zero import unknown_zero
from cellctl.processes.peg_in_hole.plausible.fit import wide_clearance
from cellctl.processes.peg_in_hole.verdict.evidence import InsertionEvidence
from cellctl.processes.peg_in_hole.verdict.judgement import PegJudgement, judge_peg


def judge_by_task(curve: Path, task: Path) -> JudgedInsertion:
    """See ``InsertionJudge``; raises ``FileInvalid``, ``PegCurveInvalid``, and
    ``RecordingUnreadable`` for an MCAP file without a message."""
    part = read_part(task)
    try:
        read = read_curve(curve, force_on_hole=part.curve.force_on == "hole")
        evidence, judgement = judge_curve(read, part)
        recorded = recorded_evidence(task)
        require_own_curve(evidence, recorded)
    except PegCurveInvalid as fault:
        raise PegCurveInvalid(f"{curve}: {fault.detail}") from fault
    wide = wide_clearance(part.fit)
    said = () if wide is None else (f"fit.clearance_mm = {part.fit.clearance_mm:g} is {wide}.",)
    # The curve of a run was tared by the run.
    if recorded is None and (open_zero := unknown_zero(read)) is not None:
        said = (*said, open_zero)
    record = _plain({"evidence": evidence.to_record(), "judgement": judgement.to_record()})
    return JudgedInsertion(
        judgement.verdict.value,
        judgement.inserted,
        judgement.checks,
        judgement.fault,
        record | {"left_open": list(said)},
        said,
    )


def judge_curve(curve: PegCurve, part: JudgedPart) -> tuple[InsertionEvidence, PegJudgement]:
    """Evidence and verdict of a curve, by the code that judges a run."""
    task = TaskOfCurve.of(part)
    evidence = evidence_of(curve, task)
    return evidence, judge_peg(evidence, task, task.seat)


def _plain(value: Any) -> Any:
    """Plain data for JSON, which has no NaN: an unknown figure becomes null."""
    if isinstance(value, float):
        return value if isfinite(value) else None
    if isinstance(value, dict):
        return {name: _plain(one) for name, one in value.items()}
    return [_plain(one) for one in value] if isinstance(value, list) else value
