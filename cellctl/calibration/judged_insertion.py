"""What a judge of recorded insertions answers, whatever process it belongs to."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cellctl.calibration.checks import Checks
from cellctl.errors.base import CellError


@dataclass(frozen=True, slots=True)
class JudgedInsertion:
    """A verdict with every figure that led to it."""

    verdict: str
    good: bool
    """Whether a part with this verdict may go on."""
    checks: Checks
    fault: CellError | None
    """Why the insertion is not good; None for a good one."""
    record: Mapping[str, Any]
    """Everything that was judged, as plain data."""
    said: tuple[str, ...] = ()
    """What the curve leaves open and no check can tell, in sentences."""


InsertionJudge = Callable[[Path, Path], JudgedInsertion]
"""Takes the file of the curve and the file that says what was inserted; raises numbered faults."""
