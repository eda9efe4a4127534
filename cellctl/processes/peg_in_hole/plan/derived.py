"""A parameter together with the formula and the inputs that it was computed from."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Derived:
    """Kept in the record, so that a reader can compute it again."""

    name: str
    value: float
    unit: str
    formula: str
    inputs: Mapping[str, float]
    """What it was computed from, by the names that stand in the formula, in SI units."""

    def __str__(self) -> str:
        inputs = ", ".join(f"{name} {value:.4g}" for name, value in self.inputs.items())
        return f"{self.name} = {self.formula} = {self.value:.4g} {self.unit} ({inputs})"

    def to_record(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "name": self.name,
            "value": self.value,
            "unit": self.unit,
            "formula": self.formula,
            "inputs": dict(self.inputs),
        }
