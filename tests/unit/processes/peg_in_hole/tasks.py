"""The two cells of the reference of issue 15, with any figure changed."""

from dataclasses import replace
from typing import Any

from cellctl.processes.peg_in_hole.task import CellFigures, FitGeometry, ForceLimits, SearchTask

_CELL = CellFigures(
    stiffness_n_m=1e6,
    dead_time_s=24e-3,
    uncertainty_m=3e-3,
    repeatability_m=0.02e-3,
    height_sigma_m=0.015e-3,
    force_sigma_n=0.3,
    friction=0.2,
)


def pin(clearance_mm: float = 0.02, *, chamfer_mm: float = 0.0, **cell: Any) -> SearchTask:
    """A precision pin in a plate."""
    fit = FitGeometry(3e-3, clearance_mm * 1e-3, chamfer_mm * 1e-3, chamfer_mm * 1e-3, 12e-3)
    return SearchTask(fit, replace(_CELL, **cell), ForceLimits(8, 30, 50, 1))


def plug(clearance_mm: float = 0.15, *, chamfer_mm: float = 0.3, **cell: Any) -> SearchTask:
    """A connector with an outer face."""
    chamfer_m = chamfer_mm * 1e-3
    fit = FitGeometry(14e-3, clearance_mm * 1e-3, chamfer_m, chamfer_m, 10e-3, 16.5e-3)
    return SearchTask(fit, replace(_CELL, **cell), ForceLimits(10, 80, 100, 2))
