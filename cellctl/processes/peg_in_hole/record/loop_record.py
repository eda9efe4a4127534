"""What procedure 301 has found, as plain data, and back to the figures that gains follow from."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from cellctl.calibration.checks import Checks, LimitCheck, evidence_to_record
from cellctl.force.contact.streamed.gains import LoopFigures
from cellctl.geometry.pose import MM
from cellctl.processes.peg_in_hole.settings import DEAD_TIME_MS, STIFFNESS_N_MM, PegSettings

if TYPE_CHECKING:
    from cellctl.cell.contact_motion.commissioning import CommissionedLoop

SIGMA_PERCENT = 10.0
"""Largest standard deviation of the stiffness. The study asks for the stiffness to a tenth (section
7 of the study of insertion by touch)."""
HYSTERESIS_MM = 0.02
"""About the repeatability of an arm: more is play in fingers or fixture."""
STIFFNESS, DEAD_TIME = "stiffness", "dead time"
"""Names of the checks that hold the result against the bounds of the settings."""
_MS = 1e-3
_METHOD = "readings at standstill, chirp and steps on the face beside the hole"


def loop_checks(found: "CommissionedLoop", bounds: PegSettings) -> Checks:
    """The verdict: does it repeat, and do the bounds hold that made the first touch slow enough?"""
    figures, fit = found.figures, found.stiffness
    percent = 100.0 * fit.sigma_n_m / fit.stiffness_n_m
    return (
        LimitCheck(STIFFNESS, figures.stiffness_n_m * MM, bounds.stiffness_n_mm, "N/mm"),
        LimitCheck(DEAD_TIME, figures.dead_time_s / _MS, bounds.dead_time_ms, "ms"),
        LimitCheck("relative sigma of the stiffness", percent, SIGMA_PERCENT, "%"),
        LimitCheck("reading off the line", fit.hysteresis_m / MM, HYSTERESIS_MM, "mm"),
    )


def loop_record(
    found: "CommissionedLoop", checks: Checks, recipe_id: int, run_number: int
) -> dict[str, Any]:
    """Plain data: N/mm and ms; ``run_number`` leads to every tick."""
    return {
        **evidence_to_record(_METHOD, checks),
        "recipe_id": recipe_id,
        "run": run_number,
        "stiffness_n_mm": found.figures.stiffness_n_m * MM,
        "sigma_n_mm": found.stiffness.sigma_n_m * MM,
        "dead_time_ms": found.figures.dead_time_s / _MS,
        "usual_dead_time_ms": found.usual_dead_time_s / _MS,
        "motion_dead_time_ms": found.motion_dead_time_s / _MS,
        "fitted": {
            "stiffness_n_mm": found.fitted.stiffness_n_m * MM,
            "dead_time_ms": found.fitted.dead_time_s / _MS,
        },
    }


def figures_of_record(record: Mapping[str, Any]) -> LoopFigures:
    """Upper bounds; raises ``ValueError`` for numbers that no cell file may have either."""
    stiffness_n_mm = float(record["stiffness_n_mm"]) + 2.0 * float(record["sigma_n_mm"])
    dead_time_ms = float(record["dead_time_ms"])
    if not (STIFFNESS_N_MM[0] <= stiffness_n_mm <= STIFFNESS_N_MM[1]):
        raise ValueError(f"stiffness of {stiffness_n_mm:g} N/mm")
    if not (DEAD_TIME_MS[0] <= dead_time_ms <= DEAD_TIME_MS[1]):
        raise ValueError(f"dead time of {dead_time_ms:g} ms")
    return LoopFigures(stiffness_n_mm / MM, dead_time_ms * _MS)
