"""Names of columns with their units: what a recorded curve may call its quantities."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from cellctl.processes.peg_in_hole.faults import PegCurveInvalid

_TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6}
_LENGTH = {"m": 1.0, "mm": 1e-3, "um": 1e-6}
_FORCE = {"n": 1.0, "kn": 1e3}
_MOMENT = {"nm": 1.0, "n_m": 1.0, "nmm": 1e-3, "n_mm": 1e-3}
TIME, X, Y, DEPTH = "time", "x", "y", "depth"
_HEIGHT = "height"
FORCES, MOMENTS = ("fx", "fy", "fz"), ("mx", "my", "mz")
NEEDED = (TIME, X, Y, DEPTH, *FORCES)
_UNITS: Mapping[str, Mapping[str, float]] = {
    TIME: _TIME,
    **dict.fromkeys((X, Y, DEPTH, _HEIGHT), _LENGTH),
    **dict.fromkeys(FORCES, _FORCE),
    **dict.fromkeys(MOMENTS, _MOMENT),
}
_ALSO = {"t": TIME, "z": DEPTH}
"""Other names of quantities."""


@dataclass(frozen=True, slots=True)
class Column:
    """Where a quantity stands in a file, and what its numbers are multiplied with."""

    name: str
    factor: float
    """Factor to SI units and to frame A: negative where the file counts out of the hole."""


def columns_of(names: Iterable[str]) -> dict[str, Column]:
    """Columns by quantity, for all of ``NEEDED`` and the moments that there are.

    Others are ignored. A height in place of a depth turns z round: the forces along it, too. Raises
    ``PegCurveInvalid`` with the names that are missing, that are there twice, or whose unit nobody
    knows.
    """
    found: dict[str, Column] = {}
    for name in names:
        quantity = _quantity(name)
        if quantity is None:
            continue
        if quantity in found:
            raise PegCurveInvalid(f"columns {found[quantity].name} and {name} are the same")
        found[quantity] = Column(name, _factor(name, quantity))
    if _HEIGHT in found:
        found = _turned_round(found)
    missing = [_with_units(quantity) for quantity in NEEDED if quantity not in found]
    if missing:
        raise PegCurveInvalid(f"missing column {', '.join(missing)}")
    return found


def _quantity(name: str) -> str | None:
    stem = name.strip().lower().partition("_")[0]
    stem = _ALSO.get(stem, stem)
    return stem if stem in _UNITS else None


def _factor(name: str, quantity: str) -> float:
    unit = name.strip().lower().partition("_")[2]
    if unit not in _UNITS[quantity]:
        raise PegCurveInvalid(f"column {name!r} has no unit that is known: {_with_units(quantity)}")
    return _UNITS[quantity][unit]


def _turned_round(found: Mapping[str, Column]) -> dict[str, Column]:
    if DEPTH in found:
        raise PegCurveInvalid(f"columns {found[DEPTH].name} and {found[_HEIGHT].name} contradict")
    turned = {
        quantity: Column(column.name, -column.factor if quantity in ("fz", "mz") else column.factor)
        for quantity, column in found.items()
    }
    height = turned.pop(_HEIGHT)
    return turned | {DEPTH: Column(height.name, -height.factor)}


def _with_units(quantity: str) -> str:
    return " or ".join(f"{quantity}_{unit}" for unit in _UNITS[quantity])
