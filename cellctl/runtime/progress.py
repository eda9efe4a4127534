"""What the cell is doing at this moment: steps write it, the daemon reads it for line and log."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace


@dataclass(frozen=True, slots=True)
class Progress:
    """A snapshot. Lengths in mm and angles in degrees, because it is only ever shown."""

    step: int = 0
    """Number of the step or procedure, 0 between runs."""
    step_label: str = ""
    contact: bool = False
    """The step deals with the trips of the guard itself."""
    safe_point_ahead: bool = True
    """A Hold takes effect before the run ends, as far as is known: a step that may have to go back
    says so when it does."""
    iteration: int = 0
    error_mm_deg: tuple[float, ...] = (math.nan,) * 6
    """x, y, z in mm, rx, ry, rz in degrees of the part against its target."""
    error_limits_mm_deg: tuple[float, ...] = (math.nan,) * 6
    """What the magnitude of each component may be at most."""
    force_peaks: tuple[float, ...] = (math.nan,) * 6
    """Greatest magnitude per component in the frame of the part, N and N·m."""
    force_limit_n: float = math.nan
    message: str = ""


def on_new_message(tell: Callable[[str], None]) -> Callable[[Progress], None]:
    """An observer that tells of every message that differs from the one before."""
    last = ""

    def observe(progress: Progress) -> None:
        nonlocal last
        if progress.message != last:
            last = progress.message
            if last:
                tell(last)

    return observe


@dataclass(slots=True)
class ProgressBoard:
    """The one place where the present progress hangs; observers are told of each change."""

    current: Progress = Progress()
    observers: list[Callable[[Progress], None]] = field(default_factory=list)

    def update(self, **changes: object) -> None:
        """Replace some fields and tell the observers."""
        self._show(replace(self.current, **changes))  # type: ignore[arg-type]

    def leave_step(self) -> None:
        """No step is under way any more; what was measured stays to be seen."""
        self.update(step=0, step_label="", contact=False, safe_point_ahead=True, iteration=0)

    def reset(self) -> None:
        """Back to nothing, at the start of a run."""
        self._show(Progress())

    def _show(self, progress: Progress) -> None:
        self.current = progress
        for observer in self.observers:
            observer(progress)
