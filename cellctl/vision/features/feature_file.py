"""The feature file of a part: its named holes, and which head sees which."""

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from cellctl.errors.vision import FeatureFileInvalid
from cellctl.files.hand_written import hand_written
from cellctl.geometry.pose import MM, Array
from cellctl.vision.features.hole import Hole
from cellctl.vision.features.known_kinds import KINDS

_HOLE_KEYS = {"name", "kind", "diameter_mm", "position_mm", "countersink_mm"}
_FILE_KEYS = {"hole", "head_1", "head_2", "outward_axis", "position_sigma_mm", "thickness_mm"}


@dataclass(frozen=True, slots=True)
class FeatureFile:
    """The holes of a part and which head sees which; both lists empty when the file has none."""

    holes: tuple[Hole, ...]
    head_1: tuple[str, ...] = ()
    head_2: tuple[str, ...] = ()
    thickness_m: float | None = None
    """Of the part, by its drawing; None when the file does not say."""

    def seen_by(self, head: Literal[1, 2]) -> tuple[Hole, ...]:
        """Holes of one head, in the order of its list."""
        by_name = {hole.name: hole for hole in self.holes}
        return tuple(by_name[name] for name in (self.head_1, self.head_2)[head - 1])


def read_features(path: Path) -> FeatureFile:
    """Read a feature file; raises ``FeatureFileInvalid`` with the reason."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise FeatureFileInvalid(f"{path}: {error.strerror or error}") from error
    return parse_features(content, str(path))


def parse_features(content: bytes, name: str) -> FeatureFile:
    """The content of a feature file of that name; raises ``FeatureFileInvalid``."""
    try:
        data = tomllib.loads(hand_written(content))
    except ValueError as error:
        raise FeatureFileInvalid(f"{name} is not TOML: {error}") from error
    try:
        return _features(data)
    except ValueError as error:
        raise FeatureFileInvalid(f"{name}: {error}") from error


def _features(data: Mapping[str, Any]) -> FeatureFile:
    # A misspelt optional key would otherwise be ignored without a word.
    if unknown := set(data) - _FILE_KEYS:
        raise ValueError(f"unknown key {sorted(unknown)[0]}")
    tables = data.get("hole", [])
    if not isinstance(tables, list) or not tables:
        raise ValueError("needs at least one [[hole]]")
    outward = _outward(data)
    sigma_m = 0.0
    if "position_sigma_mm" in data:
        sigma_m = _positive(data, "position_sigma_mm", "the file") * MM
    thickness_m = None
    if "thickness_mm" in data:
        thickness_m = _positive(data, "thickness_mm", "the file") * MM
    holes = tuple(
        replace(_hole(table, index, outward), position_sigma_m=sigma_m)
        for index, table in enumerate(tables, start=1)
    )
    names = [hole.name for hole in holes]
    if len(set(names)) != len(names):
        raise ValueError("every hole needs a name of its own")
    heads = [_head(data, key, names) for key in ("head_1", "head_2")]
    return FeatureFile(holes, heads[0], heads[1], thickness_m)


def _head(data: Mapping[str, Any], key: str, names: list[str]) -> tuple[str, ...]:
    listed = data.get(key, [])
    if not isinstance(listed, list):
        raise ValueError(f"{key} must list names of holes")  # noqa: TRY004
    if (strange := next((one for one in listed if one not in names), None)) is not None:
        raise ValueError(
            f"{key} must list names of holes; {strange!r} is none of {', '.join(names)}"
        )
    if twice := next((name for name in listed if listed.count(name) > 1), None):
        raise ValueError(f"{key} lists {twice} twice")
    return tuple(listed)


def _outward(data: Mapping[str, Any]) -> Array | None:
    if "outward_axis" not in data:
        return None
    axis = _three_numbers(data, "outward_axis", "the file")
    length = float(np.linalg.norm(axis))
    if length == 0.0:
        raise ValueError("outward_axis must have a direction")
    return axis / length


def _hole(table: Mapping[str, Any], index: int, outward: Array | None) -> Hole:
    where = f"hole {index}"
    if not isinstance(table, dict):
        raise ValueError(f"{where} is not a table")  # noqa: TRY004
    if unknown := set(table) - _HOLE_KEYS:
        raise ValueError(f"{where}: unknown key {sorted(unknown)[0]}")
    name = table.get("name")
    if not isinstance(name, str) or not name:
        raise ValueError(f"{where}: name must be a text")
    where = f"hole {name}"
    kind = table.get("kind")
    if not isinstance(kind, str) or kind not in KINDS:
        raise ValueError(f"{where}: kind must be one of {', '.join(KINDS)}")
    diameter_mm = _positive(table, "diameter_mm", where)
    countersink_mm = None
    if "countersink_mm" in table:
        countersink_mm = _positive(table, "countersink_mm", where)
        if countersink_mm <= diameter_mm:
            raise ValueError(f"{where}: countersink_mm must exceed diameter_mm")
    return Hole(
        name,
        kind,
        diameter_mm * MM,
        _three_numbers(table, "position_mm", where) * MM,
        None if countersink_mm is None else countersink_mm * MM,
        outward,
    )


def _positive(table: Mapping[str, Any], key: str, where: str) -> float:
    value = table.get(key)
    # A bool is an int in Python: ``true`` would pass as a diameter of 1 mm.
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 < value < math.inf:
        raise ValueError(f"{where}: {key} must be a positive number")
    return float(value)


def _three_numbers(table: Mapping[str, Any], key: str, where: str) -> Array:
    try:
        values = np.array(table.get(key), dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{where}: {key} must be three numbers") from None
    if values.shape != (3,) or not np.isfinite(values).all():
        raise ValueError(f"{where}: {key} must be three numbers")
    return values
