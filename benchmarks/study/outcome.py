"""What came of one seed, as it is kept."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Self


@dataclass(frozen=True, slots=True)
class StudyOutcome:
    """One trial."""

    seed: int
    good: bool
    """By the truth, and called so."""
    called_good: bool
    """With ``good`` false the worst of all ends."""
    fault: str = ""
    figures: Mapping[str, float] = field(default_factory=dict)
    detail: Mapping[str, Any] = field(default_factory=dict)
    """What tables of this kind of trial need besides."""

    def row(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)

    @classmethod
    def of(cls, row: Mapping[str, Any]) -> Self:
        """From plain data; raises ``TypeError`` for a row of another form."""
        return cls(**row)
