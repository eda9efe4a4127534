"""Read a cell file and say everything that is wrong with it."""

import tomllib
from collections.abc import Iterator, Mapping, Set
from pathlib import Path
from typing import Any, Protocol, cast

from pydantic import BaseModel, ValidationError

from cellctl import plugins
from cellctl.config.base import Section
from cellctl.config.cell import CellConfig
from cellctl.config.cross_checks import cross_issues
from cellctl.config.issue import ConfigIssue
from cellctl.config.process_definition import ProcessDefinition, process_definition
from cellctl.config.recipe import Recipe
from cellctl.config.roles import lacking
from cellctl.config.taught_pose_checks import taught_pose_issues
from cellctl.config.zone_checks import zone_issues
from cellctl.errors.config import ConfigInvalid, ConfigUnreadable, UnknownDriver

_LONGEST_VALUE = 60


def load_cell(path: Path) -> CellConfig:
    """The cell file as a model; raises ``ConfigUnreadable``, ``ConfigInvalid`` or a sibling."""
    found, cell = _examine(path)
    if cell is None or found:
        lines = [f"{issue.key} = {issue.value}: {issue.allowed}" for issue in found]
        raise ConfigInvalid(f"{path}: " + "; ".join(lines))
    return cell


def problems(path: Path) -> list[ConfigIssue]:
    """Every error of a cell file; empty when it is good. Touches no hardware."""
    return _examine(path)[0]


def cell_from_document(document: Mapping[str, Any]) -> CellConfig:
    """A cell file that was understood before, as the record of a run keeps it.

    Nothing outside of it is checked. Raises ``ConfigInvalid``, ``UnknownDriver``.
    """
    found, cell = _parse(dict(document))
    if cell is None or found:
        raise ConfigInvalid("; ".join(f"{issue.key}: {issue.allowed}" for issue in found))
    return cell


def _examine(path: Path) -> tuple[list[ConfigIssue], CellConfig | None]:
    found, cell = _parse(_read_toml(path))
    if cell is None:
        return found, None
    # Drivers first: the checks between sections ask them for figures such as the rate of a sensor.
    found += _driver_issues(cell)
    found += [
        *taught_pose_issues(cell, found),
        *zone_issues(cell, found),
        *cross_issues(cell, found),
    ]
    # Faults of devices are reported once, where they are, and not again by every recipe that uses
    # them.
    bad_devices = {".".join(issue.key.split(".")[:2]) for issue in found}
    for index, recipe in enumerate(cell.recipes):
        found += _process_issues(cell, recipe, f"recipes.{index}", path.parent, bad_devices)
    return found, cell


def _parse(raw: dict[str, Any]) -> tuple[list[ConfigIssue], CellConfig | None]:
    # Recipes and settings of processes are checked by the models that their processes bring,
    # everything else by the core's own model.
    recipes, settings = raw.pop("recipes", []), raw.pop("processes", {})
    found: list[ConfigIssue] = []
    try:
        cell = CellConfig.model_validate(raw)
    except ValidationError as error:
        found, cell = _from_pydantic("", error), None
    recipe_models = list(_recipes(recipes, found))
    needed = {recipe.process for recipe in recipe_models if recipe is not None}
    setting_models = _settings(settings, needed, found)
    if cell is None or len(recipe_models) != sum(one is not None for one in recipe_models):
        return found, None
    known = tuple(recipe for recipe in recipe_models if recipe is not None)
    return found, cell.model_copy(update={"recipes": known, "processes": setting_models})


def _read_toml(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise ConfigUnreadable(f"{path}: {error}") from error


def _recipes(raw: Any, found: list[ConfigIssue]) -> Iterator[Recipe | None]:
    """The recipes as models of their processes; None, and what is wrong, for each bad one."""
    if not isinstance(raw, list):
        found.append(ConfigIssue("recipes", _shorten(repr(raw)), "a list of [[recipes]]"))
        return
    for index, entry in enumerate(raw):
        key = f"recipes.{index}"
        # Which keys are allowed, only the process says: without it the entry cannot be checked any
        # further.
        definition = _definition(entry, key, found)
        if definition is None:
            yield None
            continue
        try:
            yield definition.recipe_model.model_validate(entry)
        except ValidationError as error:
            found += _from_pydantic(f"{key}.", error)
            yield None


def _definition(entry: Any, key: str, found: list[ConfigIssue]) -> type[ProcessDefinition] | None:
    name = entry.get("process") if isinstance(entry, dict) else None
    if not isinstance(name, str):
        value = "(missing)" if name is None else repr(name)
        allowed = "name of a process: " + (", ".join(plugins.names(plugins.PROCESS)) or "none")
        found.append(ConfigIssue(f"{key}.process", value, allowed))
        return None
    try:
        return process_definition(name)
    except UnknownDriver as error:
        found.append(ConfigIssue(f"{key}.process", repr(name), error.detail, error.number))
        return None


def _settings(raw: Any, needed: set[str], found: list[ConfigIssue]) -> dict[str, Section]:
    """Settings of each process that a recipe or the file names, with their defaults."""
    if not isinstance(raw, dict):
        found.append(ConfigIssue("processes", _shorten(repr(raw)), "tables [processes.NAME]"))
        return {}
    models: dict[str, Section] = {}
    for name in sorted(needed | set(raw)):
        try:
            settings = process_definition(name).settings_model
        except UnknownDriver as error:
            found.append(ConfigIssue(f"processes.{name}", name, error.detail, error.number))
            continue
        try:
            models[name] = settings.model_validate(raw.get(name, {}))
        except ValidationError as error:
            found += _from_pydantic(f"processes.{name}.", error)
    return models


class _WithConfig(Protocol):
    Config: type[BaseModel]


def _driver_issues(cell: CellConfig) -> list[ConfigIssue]:
    found: list[ConfigIssue] = []
    for key, (group, device) in cell.devices().items():
        try:
            driver = cast(_WithConfig, plugins.load(group, device.driver))
        except UnknownDriver as error:
            value = repr(device.driver)
            found.append(ConfigIssue(f"{key}.driver", value, error.detail, error.number))
            continue
        try:
            driver.Config.model_validate(device.settings)
        except ValidationError as error:
            found += _from_pydantic(f"{key}.settings.", error)
    return found


def _process_issues(
    cell: CellConfig, recipe: Recipe, key: str, folder: Path, bad_devices: Set[str]
) -> Iterator[ConfigIssue]:
    definition = process_definition(recipe.process)
    missing = list(lacking(cell, definition.roles, recipe, key))
    yield from missing
    taken = {f"{role.section}.{recipe.device(name)}" for name, role in definition.roles.items()}
    # Without its settings, and all of its devices in order, a process has nothing to judge by.
    if not missing and not taken & bad_devices and recipe.process in cell.processes:
        yield from definition.check(cell, recipe, key, folder)


def _from_pydantic(prefix: str, error: ValidationError) -> list[ConfigIssue]:
    found = []
    items = error.errors(include_url=False)
    # pydantic calls a list with one bad entry "too short", in addition to what is wrong with the
    # entry. That would send the user to look for a missing one.
    parents = {item["loc"][:depth] for item in items for depth in range(1, len(item["loc"]))}
    for item in items:
        if item["type"] == "too_short" and item["loc"] in parents:
            continue  # it has entries; what is wrong with them is reported by itself
        key = prefix + ".".join(str(part) for part in item["loc"])
        missing = item["type"] == "missing"
        value = "(missing)" if missing else _shorten(repr(item["input"]))
        found.append(ConfigIssue(key or "(file)", value, item["msg"]))
    return found


def _shorten(text: str, limit: int = _LONGEST_VALUE) -> str:
    return text if len(text) <= limit else text[: limit - 1] + "…"
