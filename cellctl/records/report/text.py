"""Numbers and keys of the record as words for people."""

import math
from collections.abc import Iterator, Mapping
from datetime import datetime
from typing import Any

_UNITS = {
    "_n_per_mm": "N/mm",
    "_n_per_m": "N/m",
    "_mm_s2": "mm/s²",
    "_mm_s": "mm/s",
    "_m_s": "m/s",
    "_n_m": "N·m",
    "_deg": "°",
    "_kg": "kg",
    "_um": "µm",
    "_mm": "mm",
    "_ms": "ms",
    "_hz": "Hz",
    "_px": "px",
    "_n": "N",
    "_s": "s",
    "_m": "m",
}
"""Longest first: `_n_m` is not `_m`."""
MISSING = "–"


def facts(document: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, str]]:
    """Label and value of every entry, nested ones with their path."""
    for key, value in document.items():
        if isinstance(value, Mapping):
            yield from facts(value, f"{prefix}{label(key)[0]}: ")
        else:
            name, unit = label(key)
            yield prefix + name, with_unit(plain(value), unit)


def label(key: str) -> tuple[str, str]:
    """Words and unit of a key: ``stop_latency_ms`` is ("stop latency", "ms")."""
    for suffix, unit in _UNITS.items():
        if key.endswith(suffix):
            return key.removesuffix(suffix).replace("_", " "), unit
    return key.replace("_", " "), ""


def with_unit(text: str, unit: str) -> str:
    """A value with its unit; a degree sign without a space."""
    if not unit or text == MISSING:
        return text
    return text + unit if unit == "°" else f"{text} {unit}"


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
    """Up to four significant figures, never in exponent form for sizes that occur in a cell."""
    if not math.isfinite(value):
        return MISSING
    magnitude = abs(value)
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


def when(time: datetime | None) -> str:
    """UTC to the second."""
    return MISSING if time is None else f"{time:%Y-%m-%d %H:%M:%S} UTC"


def duration(start: datetime, end: datetime | None) -> str:
    """Minutes and seconds."""
    if end is None:
        return "open"
    seconds = (end - start).total_seconds()
    return f"{seconds:.1f} s" if seconds < 120 else f"{seconds // 60:.0f} min {seconds % 60:.0f} s"


def short(sha256: str) -> str:
    """Enough of a hash to tell it from others by eye."""
    return sha256[:12] if sha256 else MISSING
