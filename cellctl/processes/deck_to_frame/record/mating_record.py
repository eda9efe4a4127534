"""Writes plan and result of a mating as plain data for the record, in mm, mm/s, N and N·m."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from cellctl.force.contact.curve import CurveStatistics
from cellctl.geometry.pose import MM, Array
from cellctl.processes.deck_to_frame.mating.limits import contact_limits
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan
from cellctl.processes.deck_to_frame.mating.result import MatingResult
from cellctl.processes.deck_to_frame.mating.settings import MatingSettings
from cellctl.processes.deck_to_frame.record.keys import PEAK_FORCE
from cellctl.records.figures import Limit


def plan_record(plan: MatingPlan) -> dict[str, Any]:
    """Window, and the speed with its formula and every figure behind it."""
    speed, figures, window = plan.speed, plan.speed.figures, plan.window
    return {
        "approach": {
            "formula": speed.FORMULA,
            "speed_mm_s": speed.speed_m_s / MM,
            "predicted_peak_n": speed.peak_n,
            "touch_n": speed.touch_n,
            "latency_n": speed.latency_n,
            "ramp_n": speed.ramp_n,
            "impact_n": speed.impact_n,
            "tare_n": speed.tare_n,
            "stop_latency_s": figures.stop_latency_s,
            "stale_s": figures.stale_s,
            "stiffness_n_per_mm": figures.stiffness_n_m * MM,
        },
        "window": {
            "expected_mm": window.expected_m / MM,
            "earliest_mm": window.earliest_m / MM,
            "latest_mm": window.latest_m / MM,
            "clear_mm": window.clear_m / MM,
        },
        "target_force_n": plan.settings.target_force_n,
        "limit_force_n": plan.settings.limit_force_n,
    }


def result_record(result: MatingResult) -> dict[str, Any]:
    """Touch, creep, hold, verdict and peaks."""
    statistics, verdict = result.statistics, result.verdict
    return {
        "outcome": result.outcome.value,
        "touch_travel_mm": result.touch_travel_m / MM,
        "touch_force_n": result.touch_force_n,
        "creep_steps": len(result.creep),
        "stiffness_n_per_mm": result.stiffness.stiffness_n_m * MM if result.stiffness else None,
        "hold_force_n": result.hold.force_n,
        "hold_lateral_n": verdict.lateral_n,
        "hold": _force_and_moment(result.hold.wrench),
        "seat_gap_mm": verdict.gap_m / MM,
        "released_force_n": result.released.force_n if result.released else None,
        "tare_mean": _force_and_moment(result.tare.mean),
        "tare_sigma": _force_and_moment(result.tare.sigma),
        **peaks_record(statistics),
        "duration_s": result.duration_s,
        **_compliance_record(result),
    }


def peaks_record(statistics: CurveStatistics) -> dict[str, float]:
    """How hard a contact has pressed, also one that was cut off."""
    return {
        "peak_force_n": statistics.peak_fz_n,
        "peak_filtered_force_n": statistics.peak_filtered_fz_n,
        "peak_lateral_n": statistics.peak_lateral_n,
        "peak_moment_n_m": statistics.peak_moment_n_m,
    }


RESULT_UNITS = {
    "hold_force": "N",
    "hold_lateral": "N",
    "seat_gap": "mm",
    "released_force": "N",
    PEAK_FORCE: "N",
    "peak_filtered_force": "N",
    "peak_lateral": "N",
    "peak_moment": "N·m",
}
"""Units of the figures with a limit, by their keys."""


def result_limits(settings: MatingSettings) -> Mapping[str, Limit]:
    """Limits of the figures of ``result_record``, by their keys.

    Peaks of single samples are judged by the guard's limits for single samples: those of the
    recipe are for filtered values, and noise alone may exceed them.
    """
    raw, seat = contact_limits(settings).raw, settings.seat
    return {
        "hold_force": Limit(seat.force_low_n, seat.force_high_n),
        "hold_lateral": Limit(upper=seat.lateral_n),
        "seat_gap": Limit(-seat.depth_m / MM, seat.depth_m / MM),
        "released_force": Limit(settings.release_low_n, settings.release_high_n),
        PEAK_FORCE: Limit(upper=settings.limit_force_n),
        "peak_filtered_force": Limit(upper=settings.limit_force_n),
        "peak_lateral": Limit(upper=raw[0]),
        "peak_moment": Limit(upper=raw[3]),
    }


def _compliance_record(result: MatingResult) -> dict[str, Any]:
    """Every move that gave way to pins, with the force that asked for it."""
    if not result.gave_way:
        return {}
    last = result.gave_way[-1].total
    return {
        "gave_way": {
            "x_mm": last.x_m / MM,
            "y_mm": last.y_m / MM,
            "yaw_deg": float(np.degrees(last.yaw_rad)),
            "moves": [
                {
                    "travel_mm": each.reading.travel_m / MM,
                    **_force_and_moment(each.reading.wrench),
                    "x_mm": each.move.x_m / MM,
                    "y_mm": each.move.y_m / MM,
                    "yaw_deg": float(np.degrees(each.move.yaw_rad)),
                    **({"searched": True} if each.searched else {}),
                }
                for each in result.gave_way
            ],
        }
    }


def _force_and_moment(wrench: Array) -> dict[str, list[float]]:
    """A wrench as two vectors of x, y, z: each in its own unit."""
    return {"force_n": wrench[:3].tolist(), "moment_n_m": wrench[3:].tolist()}
