"""The holes of a measurement and its pictures, as the steps write them down."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from cellctl.records.entries import Measurement
from cellctl.records.report.text import MISSING, facts, fixed

_PICTURE = re.compile(r"(?P<title>.+)-head-(?P<head>\d+)-(?P<side>left|right)\.\w+")
_TABULATED = frozenset({"holes", "residuals_mm"})


@dataclass(frozen=True, slots=True)
class HoleLine:
    """One hole as measured."""

    name: str
    head: str
    position: tuple[str, ...]
    """x, y, z in mm in the left camera of its head."""
    sigma_um: str
    """Root of the summed variances."""
    diameter: str
    residual_um: str
    """Distance from its registered place."""
    outlier: bool


@dataclass(frozen=True, slots=True)
class MeasurementView:
    """A measurement with its holes."""

    entry: Measurement
    holes: tuple[HoleLine, ...]
    facts: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class PictureGroup:
    """Pictures of one measurement."""

    title: str
    pictures: tuple[tuple[str, str], ...]
    """Caption and address."""


def measurement_view(entry: Measurement) -> MeasurementView:
    """Known details as a table, the others as label and value."""
    residuals = entry.detail.get("residuals_mm", {})
    outliers = entry.detail.get("outliers", ())
    holes = entry.detail.get("holes", {})
    rest = {k: v for k, v in entry.detail.items() if k not in _TABULATED and v not in ([], {})}
    return MeasurementView(
        entry=entry,
        holes=tuple(
            _hole(name, hole, residuals.get(name), name in outliers) for name, hole in holes.items()
        ),
        facts=tuple(facts(rest)),
    )


def picture_groups(addresses: Mapping[str, str]) -> tuple[PictureGroup, ...]:
    """Pictures by measurement; names that say nothing of a head keep a group of their own."""
    groups: dict[str, list[tuple[str, str]]] = {}
    for name, address in addresses.items():
        match = _PICTURE.fullmatch(name)
        title = match["title"] if match else "other"
        caption = f"head {match['head']}, {match['side']}" if match else name
        groups.setdefault(title.replace("-", " ").replace("_", " "), []).append((caption, address))
    return tuple(PictureGroup(title, tuple(pictures)) for title, pictures in groups.items())


def _hole(
    name: str,
    hole: Mapping[str, Any],
    residual_mm: Sequence[float] | None,
    outlier: bool,  # noqa: FBT001
) -> HoleLine:
    return HoleLine(
        name=name,
        head=str(hole.get("head", MISSING)),
        position=tuple(fixed(value, 3) for value in hole.get("position_mm", ())),
        sigma_um=fixed(math.hypot(*hole.get("sigma_mm", (math.nan,))) * 1e3, 1),
        diameter=fixed(hole.get("diameter_mm"), 3),
        residual_um=MISSING if residual_mm is None else fixed(math.hypot(*residual_mm) * 1e3, 1),
        outlier=outlier,
    )
