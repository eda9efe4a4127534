"""Read a cell file and say everything that is wrong with it."""

import tomllib
from collections.abc import Iterable, Iterator, Mapping, Set
from dataclasses import replace
from pathlib import Path
from typing import Any, Protocol, cast

from pydantic import BaseModel, ValidationError

from cellctl import plugins
from cellctl.config.base import Section
from cellctl.config.cell import CellConfig
from cellctl.config.checks.addresses import address_issues
from cellctl.config.checks.cross_checks import cross_issues
from cellctl.config.checks.places.taught_poses import taught_pose_issues
from cellctl.config.checks.protective_times import protective_time_issues
from cellctl.config.checks.robot_figures import robot_issues
from cellctl.config.checks.units import unit_issues
from cellctl.config.checks.zones import zone_issues
from cellctl.config.document.findings import model_issues, shorten, validated
from cellctl.config.document.lines import key_lines, line_of
from cellctl.config.document.other_files import other_kind
from cellctl.config.document.toml_hints import toml_hint
from cellctl.config.issue import ConfigIssue
from cellctl.config.process_definition import ProcessDefinition, process_definition
from cellctl.config.recipe import Recipe
from cellctl.config.roles import lacking
from cellctl.errors.config import ConfigInvalid, ConfigUnreadable, UnknownDriver
from cellctl.fault_catalogue import misnumbered
from cellctl.files.hand_written import read_hand_written
from cellctl.spelling import nearest


def load_cell(path: Path) -> CellConfig:
    """The cell file as a model; raises ``ConfigUnreadable``, ``ConfigInvalid`` or a sibling."""
    found, cell, lines = examine(path)
    if cell is None or found:
        texts = "; ".join(str(issue) for issue in placed(found, lines))
        raise ConfigInvalid(f"{path}: {texts}")
    return cell


def problems(path: Path) -> list[ConfigIssue]:
    """Every error of a cell file; empty when it is good. Touches no hardware."""
    found, _, lines = examine(path)
    return placed(found, lines)


def cell_from_document(document: Mapping[str, Any]) -> CellConfig:
    """A cell file that was understood before, as the record of a run keeps it.

    Nothing outside of it is checked. Raises ``ConfigInvalid``, ``UnknownDriver``.
    """
    found, cell = _parse(dict(document))
    if cell is None or found:
        raise ConfigInvalid("; ".join(f"{issue.key}: {issue.allowed}" for issue in found))
    return cell


def examine(
    path: Path, text: str | None = None
) -> tuple[list[ConfigIssue], CellConfig | None, dict[str, int]]:
    """Every error without its line, the cell where its keys could be read, and the line of every
    key; with ``text``, as the file would be that holds it."""
    text = _read(path) if text is None else text
    raw = _parsed(path, text)
    if kind := other_kind(raw):
        raise ConfigUnreadable(f"{path}: this is {kind}; needed is the cell file beside it")
    lines = key_lines(text)
    found, cell = _issues(raw, path.parent)
    return found, cell, lines


def placed(found: Iterable[ConfigIssue], lines: dict[str, int]) -> list[ConfigIssue]:
    """The same findings with the lines in which they stand, each once.

    Recipes of one cell share its devices, and each of them finds what is wrong with those.
    """
    return [
        replace(
            issue,
            line=line_of(issue.key, lines),
            against=tuple(replace(one, line=line_of(one.key, lines)) for one in issue.against),
        )
        for issue in dict.fromkeys(found)
    ]


def _issues(raw: dict[str, Any], folder: Path) -> tuple[list[ConfigIssue], CellConfig | None]:
    units = list(unit_issues(raw))
    found, cell = _parse(raw)
    found += _fault_number_issues()
    found = _with_units(found, units)
    if cell is None:
        return found, None
    # Drivers first: the checks between sections ask them for figures such as the rate of a sensor.
    misread = {one.key for one in units}  # a driver names its range, the unit is the reason
    found += [one for one in _driver_issues(cell) if one.key not in misread]
    found += [
        *taught_pose_issues(cell, found),
        *zone_issues(cell, found),
        *cross_issues(cell, found),
        *robot_issues(cell, bad_devices(found)),
    ]
    # Faults of devices are reported once, where they are, and not again by every recipe that uses
    # them.
    bad = bad_devices(found)
    for index, recipe in enumerate(cell.recipes):
        found += _process_issues(cell, recipe, f"recipes.{index}", folder, bad)
    # Only these of all implausible values keep a daemon from its cell: a time that is too
    # long protects nothing, and nothing in the work of a year shows it.
    found += unless_named(found, list(protective_time_issues(cell, bad)))
    # This comes last: a device at a wrong address still belongs where the process wants it, or not.
    return [*found, *address_issues(cell)], cell


def _fault_number_issues() -> list[ConfigIssue]:
    """Installed packages whose faults an operator could take for others."""
    return [
        ConfigIssue("(installed packages)", f"F{number}", allowed)
        for number, allowed in misnumbered()
    ]


def bad_devices(found: Iterable[ConfigIssue]) -> set[str]:
    """Paths of devices and recipes that have findings."""
    return {".".join(issue.key.split(".")[:2]) for issue in found}


def _with_units(found: list[ConfigIssue], units: list[ConfigIssue]) -> list[ConfigIssue]:
    """One finding for each key: what a model has against it, after the unit that it looks like."""
    by_key = {issue.key: issue.allowed for issue in units}
    both = [
        replace(issue, allowed=f"{by_key[issue.key]}; {issue.allowed}")
        if issue.key in by_key
        else issue
        for issue in found
    ]
    return both + unless_named(found, units)


def unless_named(found: list[ConfigIssue], more: list[ConfigIssue]) -> list[ConfigIssue]:
    """Further findings of keys that are not reported yet: one mistake, one message."""
    known = {issue.key for issue in found}
    return [issue for issue in more if issue.key not in known]


def _parse(raw: dict[str, Any]) -> tuple[list[ConfigIssue], CellConfig | None]:
    # Recipes and settings of processes are checked by the models that their processes bring,
    # everything else by the core's own model.
    recipes, settings = raw.pop("recipes", []), raw.pop("processes", {})
    found: list[ConfigIssue] = []
    try:
        cell = validated(CellConfig, raw)
    except ValidationError as error:
        found, cell = model_issues("", error, CellConfig, raw), None
        found = [_of_another_device(issue, raw) for issue in found]
    recipe_models = list(_recipes(recipes, found))
    needed = {recipe.process for recipe in recipe_models if recipe is not None}
    setting_models = _settings(settings, needed, found)
    if cell is None or len(recipe_models) != sum(one is not None for one in recipe_models):
        return found, None
    known = tuple(recipe for recipe in recipe_models if recipe is not None)
    return found, cell.model_copy(update={"recipes": known, "processes": setting_models})


def _of_another_device(issue: ConfigIssue, raw: Mapping[str, Any]) -> ConfigIssue:
    """A table of a device whose name was misspelt makes another device, one without a driver."""
    section, _, rest = issue.key.partition(".")
    name, _, key = rest.partition(".")
    if key != "driver" or issue.value != "(missing)" or not isinstance(raw.get(section), dict):
        return issue
    others = [other for other in raw[section] if other != name]
    known = f"; other tables here: {', '.join(others)}" if others else ""
    allowed = f"{nearest(name, others)}the name of a driver, in [{section}.{name}]{known}"
    return replace(issue, allowed=allowed)


def _read(path: Path) -> str:
    try:
        return read_hand_written(path)
    except OSError as error:
        raise ConfigUnreadable(f"{path}: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise ConfigUnreadable(f"{path}: {error}") from error


def _parsed(path: Path, text: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ConfigUnreadable(f"{path}: {error}{toml_hint(text, str(error))}") from error


def _recipes(raw: Any, found: list[ConfigIssue]) -> Iterator[Recipe | None]:
    """The recipes as models of their processes; None, and what is wrong, for each bad one."""
    if not isinstance(raw, list):
        found.append(ConfigIssue("recipes", shorten(repr(raw)), "a list of [[recipes]]"))
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
            yield validated(definition.recipe_model, entry)
        except ValidationError as error:
            found += model_issues(f"{key}.", error, definition.recipe_model, entry)
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
        found.append(ConfigIssue("processes", shorten(repr(raw)), "tables [processes.NAME]"))
        return {}
    models: dict[str, Section] = {}
    for name in sorted(needed | set(raw)):
        try:
            settings = process_definition(name).settings_model
        except UnknownDriver as error:
            found.append(ConfigIssue(f"processes.{name}", name, error.detail, error.number))
            continue
        if name not in raw and any(nearest(name, [other]) for other in raw):
            continue  # misspelt, which is told above: its keys are there
        try:
            models[name] = validated(settings, raw.get(name, {}))
        except ValidationError as error:
            if name not in raw:
                found.append(_without_table(name, error))
                continue
            found += model_issues(f"processes.{name}.", error, settings, raw[name])
    return models


def _without_table(name: str, error: ValidationError) -> ConfigIssue:
    """One finding for a table that is not there, in place of one for each of its keys."""
    keys = ", ".join(str(one["loc"][0]) for one in error.errors())
    allowed = f"a table [processes.{name}], which its recipes need, with at least {keys}"
    return ConfigIssue(f"processes.{name}", "(missing)", allowed)


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
            validated(driver.Config, device.settings)
        except ValidationError as error:
            found += model_issues(f"{key}.settings.", error, driver.Config, device.settings)
    return found


def _process_issues(
    cell: CellConfig, recipe: Recipe, key: str, folder: Path, bad_devices: Set[str]
) -> Iterator[ConfigIssue]:
    definition = process_definition(recipe.process)
    missing = list(lacking(cell, definition.roles, recipe, key))
    yield from missing
    taken = {f"{role.section}.{recipe.device(name)}" for name, role in definition.roles.items()}
    # A process can judge nothing without its settings and with any of its devices wrong.
    if not missing and not taken & bad_devices and recipe.process in cell.processes:
        yield from definition.check(cell, recipe, key, folder)
