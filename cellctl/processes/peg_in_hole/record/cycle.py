"""Search, insertion and verdict in the record: figures with limits, path and map as documents."""

from math import isfinite
from typing import Any

import numpy as np

from cellctl.calibration.checks import LimitCheck
from cellctl.errors.base import CellError
from cellctl.processes.peg_in_hole.cycle import CycleLog, CyclePlan, CycleResult
from cellctl.processes.peg_in_hole.first_contact.reactions import Contacts
from cellctl.processes.peg_in_hole.plan.phases import CyclePhase, guard_force
from cellctl.processes.peg_in_hole.record import keys
from cellctl.processes.peg_in_hole.run import PegRun
from cellctl.processes.peg_in_hole.search.hole_map import HoleMap
from cellctl.processes.peg_in_hole.search.probe import SearchTrace
from cellctl.processes.peg_in_hole.verdict.evidence import InsertionEvidence
from cellctl.processes.peg_in_hole.verdict.judgement import SLIP
from cellctl.records.entries import Figure
from cellctl.records.figures import Limit, figure
from cellctl.records.run_recorder import RunRecorder

_M_TO_MM = 1e3
_MAP_CELLS = 61
"""A drawing needs no more along one side."""


def choice_record(plan: CyclePlan) -> dict[str, Any]:
    """Order, estimates and parameters of the search, and the guard's limits in each phase."""
    guard = [guard_force(plan.task, phase).to_record() for phase in CyclePhase]
    return {**plan.choice.to_record(), "guard": guard}


async def record_search(recorder: RunRecorder, log: CycleLog) -> None:
    """Path and map of the search, whatever has become of it."""
    await recorder.document(keys.TRACE, trace_record(log.trace, log.contacts))
    await recorder.document(keys.MAP, map_record(log.hole_map))
    points = log.trace.points
    # Of a search that was ended before it touched nobody knows: it was not done in 0 s.
    searched_s = points[-1].time_s - points[0].time_s if points else None
    await recorder.figures(
        [
            figure(keys.SEARCH_TIME, searched_s, "s"),
            figure(keys.TOUCHES, float(len(points)), ""),
        ]
    )


async def record_failure(recorder: RunRecorder, log: CycleLog, fault: CellError) -> None:
    """How far a cycle has come, and what has ended it."""
    found_by = None if log.found_by is None else log.found_by.value
    await recorder.document(keys.FAILURE, {"found_by": found_by, "fault": str(fault)})


async def record_cycle(run: PegRun, result: CycleResult) -> None:
    """Everything that the verdict rests on, also of a part that it rejects."""
    await run.recorder.document(keys.CYCLE, result.to_record())
    most_n = run.facts.plan.task.limits.insertion_n
    await run.recorder.figures(
        [
            figure(keys.PEAK, result.fed.greatest_force_n, "N", limit=Limit(upper=most_n)),
            *(_figure(check, result.evidence) for check in result.judgement.checks),
        ]
    )


def _figure(check: LimitCheck, evidence: InsertionEvidence) -> Figure:
    limit = Limit(*check.bounds)
    value = check.value if isfinite(check.value) else None
    return figure(
        keys.check(check.name), value, check.unit, label=_label(check, evidence), limit=limit
    )


def _label(check: LimitCheck, evidence: InsertionEvidence) -> str:
    """Words of the key; a ratio names the forces, of which no other figure has the greatest."""
    words = f"verdict: {check.name}"
    greatest_n, grip_n = evidence.greatest_force_n, evidence.grip_force_n
    if check.name != SLIP or greatest_n is None or grip_n is None:
        return words
    return f"{words}, {greatest_n:.4g} N of {grip_n:.4g} N"


def trace_record(trace: SearchTrace, contacts: Contacts) -> dict[str, object]:
    """Path of the search: place on the face and depth in mm, and what was felt there."""
    return {
        "contacts": [
            {
                "time_s": contact.sample.time_s,
                **dict(
                    zip(
                        ("x_mm", "y_mm", "depth_mm"),
                        (contact.sample.task_position_tip_m * _M_TO_MM).tolist(),
                        strict=True,
                    )
                ),
                "class": contact.found.value,
            }
            for contact in contacts
        ],
        "points": [
            {
                "time_s": point.time_s,
                "x_mm": point.x_m * _M_TO_MM,
                "y_mm": point.y_m * _M_TO_MM,
                "depth_mm": point.depth_m * _M_TO_MM,
                "felt": point.felt.value,
            }
            for point in trace.points
        ],
    }


def map_record(hole_map: HoleMap) -> dict[str, object]:
    """What is left of the belief, in parts of its greatest value, coarse enough for a drawing."""
    step = max(1, len(hole_map.axis_m) // _MAP_CELLS)
    weights = hole_map.weights[::step, ::step]
    return {
        "reach_mm": hole_map.reach_m * _M_TO_MM,
        "weights": np.round(weights / weights.max(), 3).tolist(),
    }
