"""The insertion in the record: figures with limits, the curve as a file."""

import asyncio
from collections.abc import Mapping

from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.insertion.curve import InsertionCurve, curve_text
from cellctl.processes.antenna_module.insertion.limits import InsertionLimits
from cellctl.processes.antenna_module.insertion.verdict import InsertionJudgement
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.records.figures import Limit, figure


async def record_curve(run: PluggingRun, curve: InsertionCurve) -> None:
    """The curve as CSV, which `cellctl judge-insertion` reads."""
    # In a thread: tens of thousands of samples take a quarter of a second, and the robot has to
    # hear from the loop all the time.
    text = await asyncio.to_thread(curve_text, curve)
    await run.recorder.artefact(keys.CURVE, text.encode(), "text/csv")


async def record_judgement(
    run: PluggingRun, judgement: InsertionJudgement, limits: InsertionLimits
) -> None:
    """Verdict, features and their limits."""
    content = judgement.to_record() | {"bounds": _bounds(limits)}
    await run.recorder.document(keys.INSERTION, content)
    found = judgement.features
    seat_mm = None if found.seat_depth_m is None else found.seat_depth_m / MM
    judged = judged_limits(limits)
    await run.recorder.figures(
        [
            figure(keys.SEAT_DEPTH, seat_mm, "mm", limit=judged[keys.SEAT_DEPTH]),
            figure(keys.PEAK, found.peak_n, "N"),
            figure(keys.TOTAL, found.total_n, "N", limit=judged[keys.TOTAL]),
            figure(keys.SIDE, found.side_n, "N", limit=judged[keys.SIDE]),
            figure(keys.MOMENT_Z, found.moment_z_n_m, "N·m", limit=judged[keys.MOMENT_Z]),
        ]
    )


def judged_limits(limits: InsertionLimits) -> Mapping[str, Limit]:
    """Limits of the figures that say how the insertion went, by their keys."""
    seat, off = limits.seat_depth_m / MM, limits.seat_tolerance_m / MM
    return {
        keys.SEAT_DEPTH: Limit(seat - off, seat + off),
        keys.TOTAL: Limit(upper=limits.greatest_n + limits.over_n),
        keys.SIDE: Limit(upper=limits.sliding_side_n),
        keys.MOMENT_Z: Limit(upper=limits.moment_z_n_m),
    }


def _bounds(limits: InsertionLimits) -> list[tuple[float, float, float]]:
    """From and to a depth in mm, the axial force in N that is allowed there."""
    edges_m = (-limits.entry_height_m, limits.spring_depth_m, limits.seat_depth_m)
    begin_m = -2 * limits.entry_height_m
    rows = []
    for edge_m in edges_m:
        middle_m = (begin_m + edge_m) / 2
        rows.append((begin_m / MM, edge_m / MM, limits.at(middle_m).axial_n))
        begin_m = edge_m
    return rows
