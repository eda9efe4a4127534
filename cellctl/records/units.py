"""Units that stand at the end of a key: ``stop_latency_ms`` is "stop latency" in ms."""

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
            return key.removesuffix(suffix), unit
    return key, ""


def words(key: str) -> str:
    """A key as words."""
    return key.replace("_", " ")


def label(key: str) -> tuple[str, str]:
    """Words and unit of a key: ``stop_latency_ms`` is ("stop latency", "ms")."""
    name, unit = without_unit(key)
    return words(name), unit
