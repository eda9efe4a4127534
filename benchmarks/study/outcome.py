"""What came of one seed, as it is kept."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Self


@dataclass(frozen=True, slots=True)
class StudyOutcome:
    """One trial."""

    seed: int
    good: bool
    """True where the part truly is good, and was called so."""
    called_good: bool
    """Whether the cell called it good; where ``good`` is false, the worst of all ends."""
    fault: str = ""
    figures: Mapping[str, float] = field(default_factory=dict)
    detail: Mapping[str, Any] = field(default_factory=dict)
    """What tables of this kind of trial need besides."""

    def row(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)

    @classmethod
    def of(cls, row: Mapping[str, Any]) -> Self:
        """An outcome from plain data; raises ``TypeError`` for a row of another form."""
        return cls(**row)
