"""Holds what the settings say of arm and board against physics and the stored cameras.

The plan predicts from these figures how far the worst contact may be off: an arm that is written
better than it is lets a plug be pushed in that does not fit.
"""

from collections.abc import Iterator, Mapping, Sequence
from math import degrees
from pathlib import Path
from typing import Any

from cellctl.calibration.store.readable_record import readable_record
from cellctl.config.cell import CellConfig
from cellctl.config.checks.bounds.bound import Bound
from cellctl.config.driver_settings import reach_m
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.chain.cell_figures import RP_OVER_SIGMA
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.roles import CAMERA_1, CAMERA_2
from cellctl.processes.antenna_module.settings import AntennaSettings

_CAMERAS = (CAMERA_1, CAMERA_2)
_LEAST_RP_MM = 0.005
"""No data sheet of a six-axis arm promises less."""
_ABSOLUTE_OVER_RP = 2.0
"""Absolute accuracy over repeatability, for an arm whose geometry was calibrated by its maker."""
_WARMED_K, _GROWS_PER_K = 0.5, 11e-6
"""Least warming of an arm that works, and what steel and cast iron make of a kelvin."""
_GAP_OVER_ABSOLUTE = 0.3
"""Greatest gap that the arm's own errors leave between tray and socket over its absolute error: on
40 arms of 0.26 mm it was 0.07 mm at most (docs/plugging.md)."""
_LEAST_SQUARE_PX = 10.0
"""Corners nearer to each other blur into one another."""
_LEAST_SPAN_MM = 4.0
"""Of the corners of a board: smaller ones are not printed or etched as exactly as they are read."""


def arm_bounds(
    cell: CellConfig, arm: str, settings: AntennaSettings, where: str
) -> Iterator[Bound]:
    """Repeatability, accuracy and drift that no arm has."""
    figures = settings.arm
    why = "no data sheet of an arm promises less"
    yield Bound(f"{where}.arm.rp_mm", figures.rp_mm, why, least=_LEAST_RP_MM)
    why = f"{_ABSOLUTE_OVER_RP:g} times rp_mm: no arm reaches places better than it repeats them"
    least_mm = _ABSOLUTE_OVER_RP * figures.rp_mm
    yield Bound(f"{where}.arm.absolute_error_mm", figures.absolute_error_mm, why, least=least_mm)
    long_m = reach_m(cell.robots[arm])
    if long_m is None:
        return
    long_mm = long_m / MM
    least_deg = degrees(figures.rp_mm / RP_OVER_SIGMA / long_mm)
    why = f"what rp_mm means over links of {long_mm:.0f} mm: their joints are the same"
    yield Bound(f"{where}.arm.rp_deg", figures.rp_deg, why, least=least_deg)
    least_mm = _WARMED_K * _GROWS_PER_K * long_mm
    why = f"links of {long_mm:.0f} mm that warm by {_WARMED_K:g} K grow by so much"
    yield Bound(f"{where}.arm.drift_mm", figures.drift_mm, why, least=least_mm)


def stored_cameras(cell: CellConfig, folder: Path) -> dict[str, Mapping[str, Any]]:
    """The records of both cameras, of those that can be read."""
    read = {name: readable_record(folder / cell.calibration_dir, name) for name in _CAMERAS}
    return {name: record for name, record in read.items() if record is not None}


def gap_bounds(recipe: AntennaRecipe, settings: AntennaSettings, key: str) -> Iterator[Bound]:
    """A zero of the gap that no error of this arm explains.

    With it a module that stands that far above its seat is called good, and a seated one bad.
    """
    most_mm = _GAP_OVER_ABSOLUTE * settings.arm.absolute_error_mm
    why = (
        f"{_GAP_OVER_ABSOLUTE:g} times absolute_error_mm of the arm, the only cause of a gap at "
        "the seat; read it from the records of good modules"
    )
    yield Bound(f"{key}.gap_zero_mm", recipe.gap_zero_mm, why, least=-most_mm, most=most_mm)


def board_bounds(
    settings: AntennaSettings, where: str, stored: Mapping[str, Mapping[str, Any]]
) -> Iterator[Bound]:
    """A board that is too large or too small for the picture at its distance; ``stored`` is what
    ``stored_cameras`` gives."""
    columns, rows = (int(side) for side in settings.board.split("x"))
    key, square_mm = f"{where}.square_mm", settings.square_mm
    why = f"the corners of {settings.board} would span less than {_LEAST_SPAN_MM:g} mm"
    least_mm = _LEAST_SPAN_MM / (max(columns, rows) - 1)
    yield Bound(key, square_mm, why, least=least_mm)
    for name, record in stored.items():
        px_per_mm = record["camera_matrix"][0][0] / settings.board_distance_mm
        least_mm = _LEAST_SQUARE_PX / px_per_mm
        why = f"{_LEAST_SQUARE_PX:g} pixels of the stored {name} at board_distance_mm"
        yield Bound(key, square_mm, why, least=least_mm)
        # Landscape or portrait: the longer side of the board may lie along either.
        most_mm = min(
            max(record["image_size"]) / px_per_mm / (max(columns, rows) - 1),
            min(record["image_size"]) / px_per_mm / (min(columns, rows) - 1),
        )
        why = f"the board would not fit into the picture of the stored {name} at board_distance_mm"
        yield Bound(key, square_mm, why, most=most_mm)
        yield from _shift_bounds(settings, where, name, record["image_size"], px_per_mm)


def _shift_bounds(
    settings: AntennaSettings, where: str, name: str, image_px: Sequence[int], px_per_mm: float
) -> Iterator[Bound]:
    """Boards whose corners would leave the picture, even without a turn."""
    sides = [int(side) for side in settings.board.split("x")]
    for shift_mm, side, side_px in zip(settings.shift_mm, sides, image_px, strict=True):
        most_mm = (side_px / px_per_mm - (side - 1) * settings.square_mm) / 2.0
        why = f"corners of the board would leave the picture of the stored {name}"
        yield Bound(f"{where}.shift_mm", shift_mm, why, most=max(most_mm, 0.0))


def board_remarks(
    cell: CellConfig, settings: AntennaSettings, where: str, folder: Path
) -> Iterator[ConfigIssue]:
    """Another board than the one with which a camera was calibrated."""
    sides = [int(side) for side in settings.board.split("x")]
    for name, record in stored_cameras(cell, folder).items():
        board = record.get("board", {})
        corners, square_mm = board.get("inner_corners"), board.get("square_mm")
        if corners is not None and (list(corners), square_mm) != (sides, settings.square_mm):
            said = (
                f"the stored {name} was made with {corners[0]}x{corners[1]}, squares of "
                f"{square_mm:g} mm; right if there is another board now"
            )
            value = f"{settings.board!r}, square_mm = {settings.square_mm:g}"
            yield ConfigIssue(f"{where}.board", value, said)
            return
