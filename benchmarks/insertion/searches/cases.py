"""Cases of the table in section 3.3 of the study of insertion by touch, with its figures."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from cellctl.processes.peg_in_hole.plan.choice import SearchName
from cellctl.processes.peg_in_hole.plan.task import (
    FitGeometry,
    ForceLimits,
    SearchTask,
)
from tests.rigs.insertion.study_cell import STUDY_CELL

_SPIRAL, _VALLEY, _MAP = SearchName.SPIRAL, SearchName.TILTED_VALLEY, SearchName.PARTICLE_MAP
_ARC = SearchName.ARC
_MIDPOINT, _CIRCUMCENTRE = SearchName.PATENT_MIDPOINT, SearchName.PATENT_CIRCUMCENTRE


@dataclass(frozen=True, slots=True)
class SearchCase:
    """One row: a task, and what the reference found for each strategy, in per cent."""

    title: str
    task: SearchTask
    reference: Mapping[SearchName, float]


def _pin(
    clearance_mm: float,
    u_mm: float,
    *figures: float,
    stiffness_n_m: float = 1e6,
    chamfer_mm: float = 0.0,
) -> SearchCase:
    """A case with the per cents found by spiral, tilted valley and particle map."""
    chamfer_m = chamfer_mm * 1e-3
    fit = FitGeometry(3e-3, clearance_mm * 1e-3, chamfer_m, chamfer_m, 12e-3)
    cell = replace(STUDY_CELL, stiffness_n_m=stiffness_n_m, uncertainty_m=u_mm * 1e-3)
    task = SearchTask(fit, cell, ForceLimits(8, 30, 50, 1))
    chamfered = ", chamfered" if chamfer_mm else ""
    title = f"pin, c {clearance_mm:g}, u {u_mm:g} mm, k {stiffness_n_m:.0e} N/m{chamfered}"
    strategies = (_SPIRAL,) if chamfer_mm else (_SPIRAL, _VALLEY, _MAP)
    return SearchCase(title, task, dict(zip(strategies, figures, strict=True)))


def _plug(
    clearance_mm: float, u_mm: float, chamfer_mm: float, reference: Mapping[SearchName, float]
) -> SearchCase:
    chamfer_m = chamfer_mm * 1e-3
    fit = FitGeometry(14e-3, clearance_mm * 1e-3, chamfer_m, chamfer_m, 10e-3, 16.5e-3)
    cell = replace(STUDY_CELL, uncertainty_m=u_mm * 1e-3)
    task = SearchTask(fit, cell, ForceLimits(10, 80, 100, 2))
    chamfered = ", chamfered" if chamfer_mm else ""
    return SearchCase(f"plug, c {clearance_mm:g}, u {u_mm:g} mm{chamfered}", task, reference)


CASES: tuple[SearchCase, ...] = (
    _pin(0.10, 2, 100, 100, 99.7),
    _pin(0.10, 5, 92, 98, 98),
    _pin(0.05, 2, 93, 99.7, 100),
    _pin(0.05, 5, 49, 98, 98),
    _pin(0.02, 2, 42, 99.7, 93),
    _pin(0.02, 5, 11, 98, 90),
    _pin(0.01, 2, 12, 91, 80),
    _pin(0.01, 5, 2, 91, 75),
    _pin(0.02, 2, 43, 99.7, 98, stiffness_n_m=1e5),
    _pin(0.02, 5, 11, 99.7, 94, stiffness_n_m=1e5),
    _pin(0.02, 2, 99.7, chamfer_mm=0.5),
    _pin(0.02, 5, 100, chamfer_mm=0.5),
    _plug(0.15, 2, 0.3, {_SPIRAL: 100, _MIDPOINT: 95, _CIRCUMCENTRE: 100, _ARC: 100}),
    _plug(0.15, 5, 0.3, {_SPIRAL: 100, _MIDPOINT: 74, _CIRCUMCENTRE: 100, _ARC: 100}),
    _plug(0.15, 10, 0.3, {_SPIRAL: 100, _MIDPOINT: 58, _CIRCUMCENTRE: 100, _ARC: 100}),
    _plug(0.15, 5, 0, {_SPIRAL: 99.7, _CIRCUMCENTRE: 100, _ARC: 100}),
    _plug(0.05, 5, 0, {_SPIRAL: 49, _CIRCUMCENTRE: 97, _ARC: 100}),
)
