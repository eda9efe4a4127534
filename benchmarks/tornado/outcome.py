"""What came of one run, held against the truth."""

from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any, Self

from benchmarks.tornado.cases import Case


class Verdict(StrEnum):
    """What the cell said of the part, and whether that is true."""

    GOOD = "good"
    NOTICED = "noticed"
    """The cell did not call the part good."""
    NOT_NOTICED = "NOT NOTICED"
    """The cell called a part good that is not."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """One run; figures are those of the truth, None where there is none."""

    case: Case
    verdict: Verdict
    text: str
    """Why the part was not good."""
    lateral_mm: float | None
    """Offset at the pin holes, the worse one."""
    rotation_deg: float | None
    """Worst axis."""
    seat_gap_mm: float | None
    peak_n: float | None
    final_n: float | None
    iterations: int | None
    """Looks of the measuring loop; None where it did not run."""
    wall_s: float
    software: str
    """What was tried, with its revision."""

    @property
    def seated(self) -> bool:
        """True for a part at its seat; its offset says something only then."""
        return self.seat_gap_mm is not None and abs(self.seat_gap_mm) < 1.0

    def row(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)

    @classmethod
    def of(cls, row: dict[str, Any]) -> Self:
        """An outcome from ``row``; ``TypeError``, ``KeyError`` or ``ValueError`` for other data."""
        case, verdict = Case(**row["case"]), Verdict(row["verdict"])
        return cls(**{**row, "case": case, "verdict": verdict})
