"""What the cell is doing now, for the PLC, the log and the record. Written by steps, read by the daemon."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from cellctl.cell.step import Step
from cellctl.geometry.pose import Array


@dataclass(frozen=True, slots=True)
class Progress:
    """A snapshot. Lengths in mm and angles in degrees, because it is only ever shown."""

    step: Step = Step.NONE
    iteration: int = 0
    error_mm_deg: tuple[float, ...] = (0.0,) * 6
    """x, y, z in mm, rx, ry, rz in degrees of the deck against its target."""
    force_peaks: tuple[float, ...] = (0.0,) * 6
    """Greatest magnitude per component in the deck frame, N and N·m."""
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


def error_tuple(translation_mm: Array, rotation_deg: Array) -> tuple[float, ...]:
    """The six numbers of ``Progress.error_mm_deg``."""
    return (*map(float, translation_mm), *map(float, rotation_deg))
