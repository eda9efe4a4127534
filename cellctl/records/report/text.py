"""Writes numbers and keys of the record as words for people."""

import math
from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime
from typing import Any

from cellctl.records.units import (
    SIX,
    SIX_MM_DEG,
    WRITTEN_POSE,
    WRITTEN_POSES,
    label,
    unit_on_pages,
    words,
)

_DECIMALS = {"mm": 4, "°": 5}
"""Decimals of errors and their deviations, by unit: 0.1 µm, and what that is at an arm's length."""
MISSING = "–"
_NESTED = (Mapping, list, tuple)


def facts(document: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, str]]:
    """Label and value of every entry, nested ones with their path, those of lists with a number.

    Matrices, and lists of documents that hold further ones, are left out: they are for programs,
    which read the record.
    """
    for key, value in document.items():
        name, unit = label(key)
        if isinstance(value, Mapping):
            yield from facts(value, f"{prefix}{name}: ")
        elif not isinstance(value, list | tuple):
            yield prefix + name, _measured(value, unit)
        elif all(isinstance(one, Mapping) and not _deep(one) for one in value) and value:
            for index, one in enumerate(value, start=1):
                yield from facts(one, f"{prefix}{name} {index}: ")
        elif any(isinstance(one, _NESTED) for one in value):
            continue
        elif key.endswith(SIX_MM_DEG) and len(value) == len(SIX):
            yield prefix + words(key.removesuffix(SIX_MM_DEG)), _six(key, value)
        else:
            yield prefix + name, _measured(value, unit)


def _deep(document: Mapping[str, Any]) -> bool:
    """Whether a document holds more than numbers, texts and plain lists of them."""
    lists = [value for value in document.values() if isinstance(value, list | tuple)]
    return any(isinstance(value, Mapping) for value in document.values()) or any(
        isinstance(one, _NESTED) for value in lists for one in value
    )


def _six(key: str, values: Sequence[float | None]) -> str:
    """Six components of a pose or of an error, each with its axis and unit."""
    names = WRITTEN_POSE if key in WRITTEN_POSES else SIX
    pairs = zip(names, values, strict=True)
    return ", ".join(
        f"{axis} {with_unit(fixed(value, decimals(unit)), unit)}" for (axis, unit), value in pairs
    )


def with_unit(text: str, unit: str) -> str:
    """A value with its unit; a degree sign without a space."""
    if not unit or text == MISSING:
        return text
    return text + unit if unit == "°" else f"{text} {unit}"


def quantity(value: float | None, unit: str) -> str:
    """A number with the unit of pages; a dash where it is unknown."""
    shown, factor = unit_on_pages(unit)
    return MISSING if value is None else with_unit(number(value * factor), shown)


def _measured(value: Any, unit: str) -> str:
    """A value of a document, or several, with the unit of pages."""
    shown, factor = unit_on_pages(unit)
    return with_unit(plain(_times(value, factor)), shown)


def _times(value: Any, factor: float) -> Any:
    if isinstance(value, list | tuple):
        return [_times(one, factor) for one in value]
    # In Python a bool is an int, but a yes or no is no figure.
    if factor == 1.0 or isinstance(value, bool) or not isinstance(value, int | float):
        return value
    return value * factor


def plain(value: Any) -> str:
    """Any value of the record."""
    if value is None:
        return MISSING
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return number(value)
    if isinstance(value, list | tuple):
        return ", ".join(plain(entry) for entry in value)
    return str(value)


def number(value: float) -> str:
    """A number with up to four significant figures, never in exponent form for sizes that occur in
    a cell."""
    if not math.isfinite(value):
        return MISSING
    magnitude = abs(value)
    # Outside of this range zeros would hide the figures, so the exponent form reads better.
    if magnitude == 0 or 1e-5 <= magnitude < 1e7:
        decimals = 0 if magnitude >= 1000 else 3 - math.floor(math.log10(magnitude or 1.0))
        text = f"{value:.{max(0, min(8, decimals))}f}"
        return text.rstrip("0").rstrip(".") if "." in text else text
    return f"{value:.3g}"


def fixed(value: float | None, decimals: int, *, signed: bool = False) -> str:
    """A column entry with a fixed number of decimals and a real minus sign."""
    if value is None or not math.isfinite(value):
        return MISSING
    text = f"{value:+.{decimals}f}" if signed else f"{value:.{decimals}f}"
    return text.replace("-", "−")


def standard_uncertainty(sigma: float | None, decimals: int) -> str:
    """``u 0.0012``: not written with ±, which stands for an expanded one (JCGM 100, 7.2.2)."""
    return f"u {fixed(sigma, decimals)}"


def decimals(unit: str) -> int:
    """Decimals of an error in a unit."""
    return _DECIMALS.get(unit, 3)


def when(time: datetime | None) -> str:
    """A time in UTC, to the second; a dash where it is unknown."""
    return MISSING if time is None else f"{time:%Y-%m-%d %H:%M:%S} UTC"


def duration(start: datetime, end: datetime | None) -> str:
    """Time between two moments, in seconds or in minutes and seconds; "open" without an end."""
    if end is None:
        return "open"
    exact_s = (end - start).total_seconds()
    if exact_s < 120:
        return f"{exact_s:.1f} s"
    # Rounded before it is divided: 179.6 s are 3 min 0 s, and not 2 min 60 s.
    minutes, seconds = divmod(round(exact_s), 60)
    return f"{minutes} min {seconds} s"


def short(sha256: str) -> str:
    """Enough of a hash to tell it from others by eye."""
    return sha256[:12] if sha256 else MISSING
