"""Every tick of a streamed contact, for the record: where the tip was and what it felt."""

import csv
import io
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from cellctl.cell.contact_motion.ticks import ContactTick, MotionKind, TickObserver
from cellctl.geometry.pose import Array

COLUMNS = (
    "time_s", "x_mm", "y_mm", "depth_mm", "fx_n", "fy_n", "fz_n", "mx_nm", "my_nm", "mz_nm",
)  # fmt: skip
"""Time from the first tick, tip in frame A, force and moment of the hole on the peg about it."""
LOOP_COLUMNS = ("speed_mm_s", "at_bound", "age_ms", "force_age_ms")
"""Speed of the tip as it was commanded, axes that had given way as far as they may, time since the
tick before, age of the newest force; files of earlier versions have none of them."""
MOTION, KIND = "motion", "kind"
"""Number and kind of the motion of a tick; files of the first versions have neither."""
_HEADS = (COLUMNS, (*COLUMNS, MOTION, KIND), (*COLUMNS, *LOOP_COLUMNS, MOTION, KIND))
_M_TO_MM, _S_TO_MS = 1e3, 1e3


@dataclass(slots=True)
class TickLog(TickObserver):
    """Kept in memory until the stream has ended; at 50 ticks a second that is little."""

    rows: list[tuple[float, ...]] = field(default_factory=list)
    motions: list[tuple[int, MotionKind]] = field(default_factory=list)
    """Number and kind of the motion of each row."""
    begun_s: float | None = None

    def take(self, tick: ContactTick) -> None:
        """See ``TickObserver``."""
        sample = tick.sample
        if self.begun_s is None:
            self.begun_s = sample.time_s
        self.rows.append(
            (
                sample.time_s - self.begun_s,
                *(sample.task_position_tip_m * _M_TO_MM).tolist(),
                *sample.force_n.tolist(),
                *sample.moment_n_m.tolist(),
                tick.speed_m_s * _M_TO_MM,
                float(tick.at_bound),
                tick.age_s * _S_TO_MS,
                tick.force_age_s * _S_TO_MS,
            )
        )
        self.motions.append((tick.motion, tick.kind))

    def text(self) -> str:
        """As CSV with a head line; four decimals are finer than sensor and encoders."""
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow((*COLUMNS, *LOOP_COLUMNS, MOTION, KIND))
        for row, (motion, kind) in zip(self.rows, self.motions, strict=True):
            writer.writerow([*(f"{value:.4f}" for value in row), motion, kind])
        return out.getvalue()

    @property
    def peaks(self) -> Array:
        """Greatest magnitude of each component of force and moment, shape (6,)."""
        if not self.rows:
            return np.full(6, np.nan)
        return np.asarray(np.abs(np.array(self.rows)[:, 4:10]).max(axis=0))


@dataclass(frozen=True, slots=True, eq=False)
class ReadTicks:
    """A table of ticks; arrays of shape (n,)."""

    values: Mapping[str, Array]
    """Columns by the names of ``COLUMNS``, and of ``LOOP_COLUMNS`` where the file has them."""
    kinds: tuple[str, ...]
    """Kind of the motion for each tick; empty where the file does not say."""


def read_ticks(text: str) -> ReadTicks:
    """Raises ``ValueError`` for what is no such table."""
    try:
        rows = list(csv.reader(io.StringIO(text)))
    except csv.Error as error:
        raise ValueError(f"no table of ticks: {error}") from error
    # With other columns or other units it would be read, and be wrong.
    if len(rows) < 2 or tuple(rows[0]) not in _HEADS:
        raise ValueError("no table of ticks")
    head, *ticks = rows
    if {len(row) for row in ticks} != {len(head)}:
        raise ValueError("rows of different lengths")
    names = [name for name in head if name not in (MOTION, KIND)]
    values = np.array([[float(cell) for cell in row[: len(names)]] for row in ticks])
    kinds = tuple(row[-1] for row in ticks) if head[-1] == KIND else ()
    return ReadTicks({name: values[:, index] for index, name in enumerate(names)}, kinds)
