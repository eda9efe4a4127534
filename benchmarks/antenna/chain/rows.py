"""Rows of the campaign's table: many cells of one grade, in worker processes."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.antenna.chain.arms import Grade, Repeatability
from benchmarks.antenna.chain.closing_look import close_by_steps, draw_taught_offset
from benchmarks.antenna.chain.drawn_cell import draw_cell
from benchmarks.antenna.chain.trials import PATTERN, Bench, Conditions, believed_cell
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
        """For the table."""
        parts = [self.grade.name, self.repeatability.name, f"{self.conditions.kelvin:g} K"]
        if self.conditions.slot_m:
            parts.append(f"slot {self.conditions.slot_m * 1e3:.0f} mm away")
        if self.conditions.socket_looks > 1:
            parts.append(f"{self.conditions.socket_looks} looks")
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
        """Per axis."""
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


def draw_row(
    pool: Executor, row: Row, seeds: Sequence[int], plugs_per_cell: int
) -> Mapping[str, Drawn]:
    """All cells of a row; by scheme."""
    jobs = [(row, seed, plugs_per_cell) for seed in seeds]
    results = list(pool.map(_one_cell, jobs))
    return {
        name: Drawn(
            np.concatenate([errors[name] for errors, _ in results]),
            float(np.mean([predicted[name] for _, predicted in results if name in predicted])),
        )
        for name in results[0][0]
    }


def _one_cell(job: tuple[Row, int, int]) -> tuple[dict[str, Array], dict[str, float]]:
    row, seed, plugs = job
    # The cell and what happens in it have streams of their own: rows of one grade and one seed
    # differ in what they vary and in nothing else.
    cell = draw_cell(np.random.default_rng([seed, 1]), row.grade, row.repeatability)
    if row.misaligned is not None:
        cell = cell.misaligned(np.random.default_rng([seed, 2]), *row.misaligned)
    rng = np.random.default_rng([seed, 3])
    believed = believed_cell(cell, row.grade, row.conditions.kelvin)
    schemes = [SCHEMES[name] for name in row.schemes]
    result = Bench(cell, believed, rng).run(schemes, row.conditions, plugs)
    errors, predicted = dict(result.errors), dict(result.predicted_p99_m)
    if "difference" in errors:
        offset = draw_taught_offset(rng)
        closed = [close_by_steps(error, offset, rng) for error in errors["difference"]]
        errors[CLOSED] = np.array(closed)
        # The plan predicts the place before the last look; what follows it has its own budget.
        predicted[CLOSED] = float("nan")
    return errors, predicted


def at_distance(row: Row, slot_m: float) -> Row:
    """The row with a slot that was not taught."""
    return replace(row, conditions=replace(row.conditions, slot_m=slot_m))
