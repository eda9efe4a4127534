"""The cell of section 3.3 of the study of insertion by touch."""

from cellctl.processes.peg_in_hole.plan.task import CellFigures

STUDY_CELL = CellFigures(
    stiffness_n_m=1e6,
    dead_time_s=24e-3,
    uncertainty_m=3e-3,
    repeatability_m=0.02e-3,
    height_sigma_m=0.015e-3,
    force_sigma_n=0.3,
    friction=0.2,
)
