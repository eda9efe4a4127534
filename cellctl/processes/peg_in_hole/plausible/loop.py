"""Holds what the settings say of arm and loop against physics and what was measured."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from cellctl.calibration.store.readable_record import readable_record
from cellctl.config.cell import CellConfig
from cellctl.config.checks.bounds.bound import Bound
from cellctl.config.checks.plausible.sensors import NOISE_SHARE
from cellctl.config.driver_settings import measuring_range, sensor_rate_hz
from cellctl.config.issue import ConfigIssue
from cellctl.processes.peg_in_hole.calibrations import CONTACT_LOOP
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.roles import FORCE
from cellctl.processes.peg_in_hole.settings import PegSettings

_LEAST_REPEATABILITY_MM = 0.005
"""No data sheet of a six-axis arm promises less."""
_LEAST_HEIGHT_SHARE = 0.1
"""Least noise of a height over the repeatability: heights are read from the same joints."""
_STREAM_PERIOD_MS = 4.0
"""Of the fastest controllers; a setpoint takes effect two periods after the force at the least."""
_MOST_NOISE = 0.01
"""Of the range of a force sensor, as the standard deviation of its samples."""
_SOFT_N_MM = 25.0
"""Softer are only arms of a few kilograms payload with long links."""


def loop_bounds(
    cell: CellConfig, recipe: PegRecipe, settings: PegSettings, folder: Path
) -> Iterator[Bound]:
    """Figures that are better than any arm or sensor, or than those that procedure 301 found."""
    where = f"processes.{recipe.process}"
    yield from _bounds_of_loop(cell, recipe, settings, folder, where)
    why = "no data sheet of an arm promises less; the search is chosen by it"
    repeats_mm = settings.repeatability_mm
    yield Bound(f"{where}.repeatability_mm", repeats_mm, why, least=_LEAST_REPEATABILITY_MM)
    why = "a tenth of repeatability_mm: heights are read from the same joints"
    least_mm = _LEAST_HEIGHT_SHARE * repeats_mm
    yield Bound(f"{where}.height_sigma_mm", settings.height_sigma_mm, why, least=least_mm)
    why = "height_uncertainty_mm: beyond it the face is not found at all, so nothing is compared"
    most_mm = recipe.base_T_hole.height_uncertainty_mm
    yield Bound(f"{where}.panel_shift_mm", settings.panel_shift_mm, why, most=most_mm)
    measuring = measuring_range(cell.force_sensors[recipe.device(FORCE)])
    if measuring:
        least_n = NOISE_SHARE * min(measuring[:3])
        why = (
            "1/10000 of the sensor's range is its own noise, and by less a dead sensor would be "
            "taken for a living one"
        )
        yield Bound(f"{where}.force_sigma_n", settings.force_sigma_n, why, least=least_n)
        most_n = _MOST_NOISE * min(measuring[:3])
        why = (
            f"{_MOST_NOISE:g} of the sensor's range: the noise of sensors lies far below, and with "
            "more no contact is told from it"
        )
        yield Bound(f"{where}.force_sigma_n", settings.force_sigma_n, why, most=most_n)


def _bounds_of_loop(
    cell: CellConfig, recipe: PegRecipe, settings: PegSettings, folder: Path, where: str
) -> Iterator[Bound]:
    sample_ms = 1e3 / sensor_rate_hz(cell.force_sensors[recipe.device(FORCE)])
    least_ms = 2 * _STREAM_PERIOD_MS + sample_ms
    why = "an upper bound: two setpoints of a stream and one sample of the sensor take longer"
    yield Bound(f"{where}.dead_time_ms", settings.dead_time_ms, why, least=least_ms)
    measured = stored_loop(cell, recipe, folder)
    if measured is None:
        return
    for name in ("stiffness_n_mm", "dead_time_ms"):
        least = measured.get(name)
        if isinstance(least, int | float):
            why = f"an upper bound, and the stored {_name(recipe)} measured so much"
            yield Bound(f"{where}.{name}", float(getattr(settings, name)), why, least=float(least))


def stored_loop(cell: CellConfig, recipe: PegRecipe, folder: Path) -> Mapping[str, Any] | None:
    """What procedure 301 has found for this recipe; None where nothing valid can be read."""
    return readable_record(folder / cell.calibration_dir, _name(recipe))


def _name(recipe: PegRecipe) -> str:
    return CONTACT_LOOP.for_recipe(recipe.id).name


def soft_arm(
    cell: CellConfig, recipe: PegRecipe, settings: PegSettings, folder: Path
) -> Iterator[ConfigIssue]:
    """A remark on an arm that is softer than most, while nothing has measured it."""
    if settings.stiffness_n_mm >= _SOFT_N_MM or stored_loop(cell, recipe, folder) is not None:
        return
    said = (
        f"an upper bound, and most arms are stiffer than {_SOFT_N_MM:g} N/mm; with a bound that is "
        "too low the first touches are too fast, also those of procedure 301 that measures it"
    )
    where = f"processes.{recipe.process}.stiffness_n_mm"
    yield ConfigIssue(where, f"{settings.stiffness_n_mm:g}", said)
