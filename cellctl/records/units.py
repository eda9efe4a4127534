"""Units that stand at the end of a key: ``stop_latency_ms`` is "stop latency" in ms.

And the units of pages, which are the same wherever a quantity comes from.
"""

from math import degrees

_UNITS = {
    "_n_m_rad": "N·m/rad",
    "_n_per_mm": "N/mm",
    "_n_per_m": "N/m",
    "_n_s_m": "N·s/m",
    "_rad_s2": "rad/s²",
    "_deg_s2": "°/s²",
    "_mm_s2": "mm/s²",
    "_m_s2": "m/s²",
    "_rad_s": "rad/s",
    "_deg_s": "°/s",
    "_mm_s": "mm/s",
    "_m_s": "m/s",
    "_n_mm": "N/mm",
    "_n_m": "N·m",
    "_percent": "%",
    "_deg_c": "°C",
    "_hpa": "hPa",
    "_px2": "px²",
    "_mm2": "mm²",
    "_deg": "°",
    "_rad": "rad",
    "_m2": "m²",
    "_nm": "N·m",
    "_kg": "kg",
    "_um": "µm",
    "_mm": "mm",
    "_ms": "ms",
    "_ns": "ns",
    "_hz": "Hz",
    "_px": "px",
    "_db": "dB",
    "_n": "N",
    "_s": "s",
    "_m": "m",
    "_h": "h",
}
"""Longest first: `_n_m` is not `_m`, and `_n_mm` not `_mm`."""
_RISES = ("stiffness", "slope", "spring")
"""Words before `_n_m` of a force over a way. Of all other keys it ends a moment."""
_ON_PAGES = {
    "m": ("mm", 1e3),
    "m/s": ("mm/s", 1e3),
    "m/s²": ("mm/s²", 1e3),
    "N/m": ("N/mm", 1e-3),
    "rad": ("°", degrees(1.0)),
    "rad/s": ("°/s", degrees(1.0)),
    "rad/s²": ("°/s²", degrees(1.0)),
}
"""Units in which programs compute, those of the same quantity on pages, and the factor."""
KNOWN_UNITS = frozenset(_UNITS.values())

SIX_MM_DEG = "_mm_deg"
"""Ends the key of six numbers: components of a pose or of an error, in the order of ``SIX``."""
SIX = (("x", "mm"), ("y", "mm"), ("z", "mm"), ("rx", "°"), ("ry", "°"), ("rz", "°"))
WRITTEN_POSE = (("X", "mm"), ("Y", "mm"), ("Z", "mm"), ("A", "°"), ("B", "°"), ("C", "°"))
"""A pose in its written form (docs/decisions/0001)."""
WRITTEN_POSES = frozenset({"xyz_abc_mm_deg", "commanded_mm_deg"})
"""Keys with a pose and not with an error."""


def without_unit(key: str) -> tuple[str, str]:
    """A key without its unit, and the unit: ``stop_latency_ms`` is ("stop_latency", "ms")."""
    for suffix, unit in _UNITS.items():
        if key.endswith(suffix):
            name = key.removesuffix(suffix)
            rise = suffix == "_n_m" and name.endswith(_RISES)
            return name, "N/m" if rise else unit
    return key, ""


def unit_on_pages(unit: str) -> tuple[str, float]:
    """The unit in which people read what has this one, and the factor: mm, degrees, N/mm.

    A record in which one length stands in metres and the next in millimetres is misread.
    """
    return _ON_PAGES.get(unit, (unit, 1.0))


def scaled(value: float | None, factor: float) -> float | None:
    """What is not known stays so."""
    return None if value is None else value * factor


def words(key: str) -> str:
    """A key as words."""
    return key.replace("_", " ")


def label(key: str) -> tuple[str, str]:
    """Words and unit of a key: ``stop_latency_ms`` is ("stop latency", "ms")."""
    name, unit = without_unit(key)
    return words(name), unit
