"""Numbers that look as if they were written in another unit than their key says.

Every rule asks for what no cell has: a joint target within a sixtieth of a turn in all six axes, a
flange whose box is smaller than a hand, a tool offset of less than a millimetre. What could be
meant as it stands passes.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from cellctl.config.document.leaves import leaves
from cellctl.config.issue import ConfigIssue

_LARGEST_RAD = 2.0 * math.pi
_QUARTERS_RAD = (math.pi / 4.0, math.pi / 2.0, math.pi, 3.0 * math.pi / 2.0)
_LEAST_PLACE_MM = 20.0
"""A place in a robot's base, or a corner of its box, is farther from the base than this."""
_LEAST_OFFSET_MM = 1.0
"""What is mounted on a flange is farther from it than this, or at zero."""
_LEAST_COM_MM = 5.0
"""The middle of what hangs on a flange or a sensor is farther from it than this."""
_LONGEST_WAIT_S = 100.0
_MICROSECONDS = 1000.0
"""Cameras state their exposure in microseconds. No wait in milliseconds is as large a number."""
_RADIANS = "degrees; these look like radians"
_METRES = "millimetres; these look like metres"


def unit_issues(section: Mapping[str, Any]) -> Iterator[ConfigIssue]:
    """Everything in a file, as it was written, that looks like radians, metres or milliseconds."""
    for key, value in leaves(section):
        if allowed := _looks_wrong(key, value):
            yield ConfigIssue(key, str(value), allowed)


def _looks_wrong(key: str, value: object) -> str:
    name = key.rsplit(".", 1)[-1]
    if isinstance(value, int | float) and not isinstance(value, bool):
        return _number(name, float(value))
    if name == "dh" and isinstance(value, list):
        return _table(value)
    return _list(key, name, _numbers(value))


def _list(key: str, name: str, numbers: Sequence[float]) -> str:
    largest = _largest(numbers)
    if len(numbers) == 6 and name == "pose":
        name = key.split(".")[-2]  # a table with the place and how far off it may be
    if len(numbers) == 6 and "_T_" in name:
        return _pose(name, numbers)
    if len(numbers) == 6 and ("_deg" in name or ".poses_deg." in key):
        return _RADIANS if 0.0 < largest <= _LARGEST_RAD else ""
    if len(numbers) == 3 and name.startswith("com_"):
        return _METRES if 0.0 < largest < _LEAST_COM_MM else ""
    box = name.endswith(("min_mm", "max_mm"))
    return _METRES if box and 0.0 < largest < _LEAST_PLACE_MM else ""


def _number(name: str, value: float) -> str:
    if name == "a1_mm" and 0.0 < value < _LEAST_OFFSET_MM:
        return _METRES
    rate = name.endswith(("mm_s", "deg_s", "m_s"))
    if name.endswith("_s") and not rate and value >= _LONGEST_WAIT_S:
        finer = " or microseconds" if value >= _MICROSECONDS else ""
        return f"seconds, less than {_LONGEST_WAIT_S:g}; this looks like milliseconds{finer}"
    return ""


def _pose(name: str, numbers: Sequence[float]) -> str:
    place, angles = numbers[:3], numbers[3:]
    least = _LEAST_PLACE_MM if name.startswith("base_T_") else _LEAST_OFFSET_MM
    if 0.0 < _largest(place) < least:
        return _METRES
    return _RADIANS if _any_quarter(angles) else ""


def _table(rows: list[Any]) -> str:
    """A Denavit-Hartenberg table: angle and twist in degrees, two lengths in mm."""
    known = [numbers for row in rows if len(numbers := _numbers(row)) == 4]
    if _any_quarter([angle for row in known for angle in (row[0], row[3])]):
        return _RADIANS
    lengths = _largest([length for row in known for length in row[1:3]])
    return _METRES if 0.0 < lengths < _LEAST_PLACE_MM else ""


def _any_quarter(angles: Sequence[float]) -> bool:
    return any(abs(abs(angle) - turn) < 2e-3 for angle in angles for turn in _QUARTERS_RAD)


def _largest(numbers: Sequence[float]) -> float:
    return max((abs(number) for number in numbers), default=0.0)


def _numbers(value: object) -> list[float]:
    """The list as numbers; empty when it is none, which the models report."""
    if not isinstance(value, list):
        return []
    if not all(isinstance(one, int | float) and not isinstance(one, bool) for one in value):
        return []
    return [float(one) for one in value]
