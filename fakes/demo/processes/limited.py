"""Figures with limits that a demonstration holds against the truth."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from fakes.demo.demo import Row


@dataclass(frozen=True, slots=True)
class Limited:
    """A figure that a good part has within limits; what is unknown is not within."""

    name: str
    key: str
    lower: float
    """Smallest value that is within the limit."""
    upper: float
    """Less than."""
    form: str
    of_the_seat: bool = True
    """Says nothing while the part is not at its seat."""

    def within(self, value: float | None) -> bool:
        """Whether it is within its limits."""
        return value is not None and self.lower <= value < self.upper

    def row(self, value: float | None) -> Row:
        """The row of this figure in the table at the end."""
        limit = f"{self.lower:g} … {self.upper:g}" if self.lower else f"{self.upper:g}"
        within = None if value is None else self.within(value)
        return Row(self.name, value, self.form, limit, within)


def failed_figures(record: Mapping[str, Any]) -> list[str]:
    """Keys of the figures that count and did not pass: the last one of each key counts."""
    verdicts = {figure["key"]: figure["verdict"] for figure in record.get("figures", [])}
    return [key for key, verdict in verdicts.items() if verdict == "fail"]
