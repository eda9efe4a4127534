"""What the verdict needs to know of drawing and cell, wherever both come from."""

from typing import Protocol

from cellctl.processes.peg_in_hole.plan.task import FitGeometry


class JudgedCell(Protocol):
    """Figures of a cell, N/m and N."""

    @property
    def stiffness_n_m(self) -> float:
        """Stiffness of arm and contact in series, along the axis of the hole."""

    @property
    def force_sigma_n(self) -> float:
        """Standard deviation of a mean of ten samples of one component."""

    @property
    def friction(self) -> float:
        """Between peg and hole."""


class JudgedTask(Protocol):
    """One peg with its hole, in one cell."""

    @property
    def fit(self) -> FitGeometry:
        """Peg and hole by the drawing."""

    @property
    def cell(self) -> JudgedCell:
        """The cell that has pushed the peg."""
