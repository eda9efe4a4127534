"""What the cell is doing now: written by steps, read by the daemon for the line and the log."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from cellctl.runtime.step import Step


@dataclass(frozen=True, slots=True)
class Progress:
    """A snapshot. Lengths in mm and angles in degrees, because it is only ever shown."""

    step: Step = Step.NONE
    iteration: int = 0
    error_mm_deg: tuple[float, ...] = (math.nan,) * 6
    """x, y, z in mm, rx, ry, rz in degrees of the deck against its target."""
    force_peaks: tuple[float, ...] = (math.nan,) * 6
    """Greatest magnitude per component in the deck frame, N and N·m."""
    force_limit_n: float = math.nan
    message: str = ""


@dataclass(slots=True)
class ProgressBoard:
    """The one place where the present progress hangs; observers are told of each change."""

    current: Progress = Progress()
    observers: list[Callable[[Progress], None]] = field(default_factory=list)

    def update(self, **changes: object) -> None:
        """Replace some fields and tell the observers."""
        self.current = replace(self.current, **changes)  # type: ignore[arg-type]
        for observer in self.observers:
            observer(self.current)

    def reset(self) -> None:
        """Back to nothing, at the start of a run."""
        self.current = Progress()
        for observer in self.observers:
            observer(self.current)
