"""Rows of the campaign's table: many cells of one grade, in worker processes."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from benchmarks.antenna.chain.arms import Grade, Repeatability
from benchmarks.antenna.chain.closing_look import close_by_steps, draw_taught_offset
from benchmarks.antenna.chain.drawn_cell import DrawnCell, draw_cell
from benchmarks.antenna.chain.trials import (
    PATTERN,
    Bench,
    CellResult,
    Conditions,
    believed_cell,
)
from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.chain.schemes import SCHEMES
from cellctl.processes.antenna_module.chain.worst_contact import contact_offsets

CLOSED = "difference, closing look"
TOLERANCE_M = 50e-6


@dataclass(frozen=True, slots=True)
class Row:
    """What one row draws."""

    grade: Grade
    repeatability: Repeatability
    conditions: Conditions
    schemes: tuple[str, ...] = tuple(SCHEMES)
    misaligned: tuple[float, float] | None = None
    """Hand-eye calibrations wrong by so many m and degrees, beside what they are anyway."""

    @property
    def name(self) -> str:
        """Name of the row in the table."""
        parts = [self.grade.name, self.repeatability.name, f"{self.conditions.kelvin:g} K"]
        if self.conditions.slot_m:
            parts.append(f"slot {self.conditions.slot_m * 1e3:.0f} mm away")
        if self.conditions.socket_looks > 1:
            parts.append(f"{self.conditions.socket_looks} looks")
        if self.conditions.teachings != Conditions().teachings:
            parts.append(f"{self.conditions.teachings} taught")
        if self.misaligned is not None:
            parts.append("hand-eye wrong")
        return ", ".join(parts)


@dataclass(frozen=True, slots=True, eq=False)
class Drawn:
    """All plugs of a row by one scheme."""

    errors: Array
    """Shape (n, 3): x, y (m), yaw (rad)."""
    predicted_p99_m: float
    """Mean over the cells."""

    @property
    def worst_m(self) -> Array:
        """Distance of the worst contact, shape (n,)."""
        return np.asarray(contact_offsets(self.errors, PATTERN.positions_m).max(axis=1))

    @property
    def rms_m(self) -> float:
        """Root mean square per axis."""
        return float(np.sqrt((self.errors[:, :2] ** 2).mean()))

    @property
    def within(self) -> int:
        """Plugs whose worst contact is within the tolerance."""
        return int((self.worst_m <= TOLERANCE_M).sum())

    def to_record(self) -> dict[str, float]:
        """Figures in µm and degrees."""
        worst = self.worst_m * 1e6
        return {
            "plugs": len(worst),
            "within": self.within,
            "rms_um": self.rms_m * 1e6,
            "median_um": float(np.median(worst)),
            "p95_um": float(np.quantile(worst, 0.95)),
            "p99_um": float(np.quantile(worst, 0.99)),
            "max_um": float(worst.max()),
            "yaw_rms_deg": float(np.degrees(np.sqrt((self.errors[:, 2] ** 2).mean()))),
            "predicted_p99_um": self.predicted_p99_m * 1e6,
        }


def draw_rows(
    pool: Executor, rows: Sequence[Row], seeds: Sequence[int], plugs_per_cell: int
) -> list[Mapping[str, Drawn]]:
    """Rows of one arm and one repeatability, in the same cells; by row, then by scheme."""
    jobs = [(tuple(rows), seed, plugs_per_cell) for seed in seeds]
    by_cell = list(pool.map(_one_cell, jobs))
    return [_together([cell[index] for cell in by_cell]) for index in range(len(rows))]


def _together(cells: Sequence[CellResult]) -> Mapping[str, Drawn]:
    return {
        name: Drawn(
            np.concatenate([cell.errors[name] for cell in cells]),
            float(np.mean([cell.predicted_p99_m.get(name, np.nan) for cell in cells])),
        )
        for name in cells[0].errors
    }


def _one_cell(job: tuple[tuple[Row, ...], int, int]) -> list[CellResult]:
    rows, seed, plugs = job
    # The cell and what happens in it have streams of their own: rows of one seed differ in what
    # they vary and in nothing else.
    cell = draw_cell(np.random.default_rng([seed, 1]), rows[0].grade, rows[0].repeatability)
    return [_one_row(row, cell, seed, plugs) for row in rows]


def _one_row(row: Row, cell: DrawnCell, seed: int, plugs: int) -> CellResult:
    if row.misaligned is not None:
        cell = cell.misaligned(np.random.default_rng([seed, 2]), *row.misaligned)
    rng = np.random.default_rng([seed, 3])
    believed = believed_cell(cell, row.grade, row.conditions.kelvin)
    schemes = [SCHEMES[name] for name in row.schemes]
    result = Bench(cell, believed, rng).run(schemes, row.conditions, plugs)
    offset = draw_taught_offset(rng)
    closed = [close_by_steps(error, offset, rng) for error in result.errors["difference"]]
    # The plan predicts the place before the closing look, so that has no prediction.
    return CellResult({**result.errors, CLOSED: np.array(closed)}, result.predicted_p99_m)
