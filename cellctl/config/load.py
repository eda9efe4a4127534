"""Read a cell file and say everything that is wrong with it."""

import tomllib
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from cellctl import plugins
from cellctl.config.cell import CellConfig
from cellctl.config.devices import Force
from cellctl.config.issue import Problem
from cellctl.config.sensor import least_stale_ms
from cellctl.errors.config import ConfigInvalid, ConfigUnreadable, MixedSimulation, UnknownDriver
from cellctl.processes.deck_to_frame.feature_checks import feature_problems

DRIVER_GROUPS = {
    "robots.main": plugins.ROBOT,
    "robots.aux_1": plugins.ROBOT,
    "robots.aux_2": plugins.ROBOT,
    "heads.head_1": plugins.STEREO_CAMERA,
    "heads.head_2": plugins.STEREO_CAMERA,
    "tracker": plugins.TARGET_TRACKER,
    "force.sensor": plugins.FT_SENSOR,
    "force.stop_channel": plugins.STOP_CHANNEL,
}


def load_cell(path: Path) -> CellConfig:
    """The cell file as a model; raises ``ConfigUnreadable``, ``ConfigInvalid`` or a sibling."""
    found, cell = _examine(path)
    if cell is None or found:
        lines = [f"{problem.key} = {problem.value}: {problem.allowed}" for problem in found]
        raise ConfigInvalid(f"{path}: " + "; ".join(lines))
    return cell


def problems(path: Path) -> list[Problem]:
    """Every error of a cell file; empty when it is good. Touches no hardware."""
    return _examine(path)[0]


def _examine(path: Path) -> tuple[list[Problem], CellConfig | None]:
    raw = _read_toml(path)
    try:
        cell = CellConfig.model_validate(raw)
    except ValidationError as error:
        return _from_pydantic("", error), None
    found = _driver_problems(cell) + list(feature_problems(cell, path.parent))
    if not any(problem.key.startswith("force.sensor.") for problem in found):
        found += _pace_problems(cell.force)
    flags = {device.simulated for device in cell.devices().values()}
    if len(flags) > 1:
        named = [key for key, device in cell.devices().items() if device.simulated]
        text = f"{MixedSimulation.text}; mark all or none"
        found.append(Problem("simulated", ", ".join(named), text, MixedSimulation.number))
    return found, cell


def _read_toml(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise ConfigUnreadable(f"{path}: {error}") from error


def _driver_problems(cell: CellConfig) -> list[Problem]:
    found: list[Problem] = []
    for key, device in cell.devices().items():
        try:
            settings_model: type[BaseModel] = plugins.load(DRIVER_GROUPS[key], device.driver).Config  # type: ignore[attr-defined]
        except UnknownDriver as error:
            found.append(Problem(f"{key}.driver", repr(device.driver), error.detail, error.number))
            continue
        try:
            settings_model.model_validate(device.settings)
        except ValidationError as error:
            found += _from_pydantic(f"{key}.settings.", error)
    return found


def _pace_problems(force: Force) -> list[Problem]:
    least_ms = least_stale_ms(force)
    if force.stale_ms >= least_ms:
        return []
    allowed = f"at least {least_ms:g}, two samples at the sensor's rate"
    return [Problem("force.stale_ms", f"{force.stale_ms:g}", allowed)]


def _from_pydantic(prefix: str, error: ValidationError) -> list[Problem]:
    found = []
    items = error.errors(include_url=False)
    parents = {item["loc"][:depth] for item in items for depth in range(1, len(item["loc"]))}
    for item in items:
        if item["type"] == "too_short" and item["loc"] in parents:
            continue  # it has entries; what is wrong with them is reported by itself
        key = prefix + ".".join(str(part) for part in item["loc"])
        missing = item["type"] == "missing"
        value = "(missing)" if missing else _shorten(repr(item["input"]))
        found.append(Problem(key or "(file)", value, item["msg"]))
    return found


def _shorten(text: str, limit: int = 60) -> str:
    return text if len(text) <= limit else text[: limit - 1] + "…"
