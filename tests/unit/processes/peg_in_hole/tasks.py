"""The two cells of the study of insertion by touch, with any figure changed."""

from dataclasses import replace
from typing import Any

from cellctl.processes.peg_in_hole.plan.task import FitGeometry, ForceLimits, SearchTask
from tests.rigs.insertion.study_cell import STUDY_CELL


def pin(clearance_mm: float = 0.02, *, chamfer_mm: float = 0.0, **cell: Any) -> SearchTask:
    """A precision pin in a plate."""
    fit = FitGeometry(3e-3, clearance_mm * 1e-3, chamfer_mm * 1e-3, chamfer_mm * 1e-3, 12e-3)
    return SearchTask(fit, replace(STUDY_CELL, **cell), ForceLimits(8, 30, 50, 1))


def plug(clearance_mm: float = 0.15, *, chamfer_mm: float = 0.3, **cell: Any) -> SearchTask:
    """A connector with an outer face."""
    chamfer_m = chamfer_mm * 1e-3
    fit = FitGeometry(14e-3, clearance_mm * 1e-3, chamfer_m, chamfer_m, 10e-3, 16.5e-3)
    return SearchTask(fit, replace(STUDY_CELL, **cell), ForceLimits(10, 80, 100, 2))
