"""Samples of one insertion."""

import csv
import io
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import MM, Array
from cellctl.processes.antenna_module.faults.plugging import InsertionCurveInvalid

COLUMNS = ("t_s", "z_mm", "fx_n", "fy_n", "fz_n", "mx_n_m", "my_n_m", "mz_n_m")
_ALSO = {"time_s": "t_s", "mx_nm": "mx_n_m", "my_nm": "my_n_m", "mz_nm": "mz_n_m"}
"""What the curve of a peg by touch calls its columns, which says the same."""
_FEWEST = 20


@dataclass(frozen=True, slots=True, eq=False)
class InsertionSample:
    """One reading, after tare."""

    t_s: float
    depth_m: float
    force_n: Array
    """Shape (3,)."""
    moment_n_m: Array
    """Shape (3,)."""

    @property
    def axial_n(self) -> float:
        """Resistance to the insertion."""
        return float(self.force_n[2])

    @property
    def side_n(self) -> float:
        """Force across the insertion axis."""
        return float(np.hypot(self.force_n[0], self.force_n[1]))

    def centre_of_pressure_m(self, least_n: float) -> Array | None:
        """x and y of where the axial force acts, shape (2,); None below ``least_n``."""
        if self.force_n[2] <= least_n:
            return None
        # From m = r × f with f along z.
        lever = np.array([-self.moment_n_m[1], self.moment_n_m[0]]) / self.force_n[2]
        return np.asarray(lever)


@dataclass(frozen=True, slots=True, eq=False)
class InsertionCurve:
    """A whole insertion; n samples."""

    t_s: Array
    """Rising, shape (n,)."""
    depth_m: Array
    """Shape (n,)."""
    force_n: Array
    """Shape (n, 3)."""
    moment_n_m: Array
    """Shape (n, 3)."""

    def __iter__(self) -> Iterator[InsertionSample]:
        for t_s, depth_m, force, moment in zip(
            self.t_s, self.depth_m, self.force_n, self.moment_n_m, strict=True
        ):
            yield InsertionSample(float(t_s), float(depth_m), force, moment)

    def after(self, t_s: float) -> "InsertionCurve":
        """The samples later than this."""
        later = self.t_s > t_s
        return InsertionCurve(
            self.t_s[later], self.depth_m[later], self.force_n[later], self.moment_n_m[later]
        )


def parse_curve(text: str) -> InsertionCurve:
    """The CSV file: columns ``COLUMNS``, by these or their other names, in any order; others are
    ignored.

    Raises ``InsertionCurveInvalid`` with the line.
    """
    reader = csv.DictReader(io.StringIO(text))
    try:
        written = reader.fieldnames or ()
        reader.fieldnames = [
            name if _ALSO.get(name, name) in written else _ALSO.get(name, name) for name in written
        ]
        missing = [name for name in COLUMNS if name not in (reader.fieldnames or ())]
        if missing:
            raise InsertionCurveInvalid(f"missing column {', '.join(missing)}{_separated(text)}")
        rows = [_numbers(row, reader.line_num) for row in reader]
    except csv.Error as error:
        raise InsertionCurveInvalid(f"line {reader.line_num}: {error}") from error
    if len(rows) < _FEWEST:
        raise InsertionCurveInvalid(f"{len(rows)} samples, at least {_FEWEST} needed")
    table = np.array(rows)
    back = np.flatnonzero(np.diff(table[:, 0]) <= 0)
    if back.size:
        raise InsertionCurveInvalid(f"sample {back[0] + 2}: time does not rise")
    return InsertionCurve(table[:, 0], table[:, 1] * MM, table[:, 2:5], table[:, 5:8])


def curve_text(curve: InsertionCurve) -> str:
    """The CSV file of a curve, which ``parse_curve`` reads; time from the first sample on."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS)
    begin_s = curve.t_s[0] if len(curve.t_s) else 0.0
    for sample in curve:
        numbers = (sample.t_s - begin_s, sample.depth_m / MM, *sample.force_n, *sample.moment_n_m)
        writer.writerow([f"{number:.6f}" for number in numbers])
    return out.getvalue()


def _separated(text: str) -> str:
    """What to say of a head without commas."""
    head = text.partition("\n")[0]
    for sign, name in ((";", "semicolons"), ("\t", "tabs")):
        if sign in head and "," not in head:
            return (
                f": the columns are separated by {name}; expected commas between them, and points "
                "in the numbers"
            )
    return ""


def _numbers(row: dict[str, str | None], line: int) -> list[float]:
    values = []
    for name in COLUMNS:
        try:
            value = float(row[name] or "")
        except ValueError as error:
            raise InsertionCurveInvalid(f"line {line}: {name} is {row[name]!r}") from error
        if not np.isfinite(value):
            raise InsertionCurveInvalid(f"line {line}: {name} is {row[name]!r}")
        values.append(value)
    return values
