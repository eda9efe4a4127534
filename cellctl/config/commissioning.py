"""What `cellctl check` asks of a cell file beyond what a daemon asks.

A cell that has worked for a year must still start after an update that asks for more. Whoever
commissions one must not leave it so.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from cellctl.clock import utc_now
from cellctl.config.cell import CellConfig
from cellctl.config.checks.arms.boxes import box_issues, box_remarks
from cellctl.config.checks.arms.needs import ArmNeeds, arm_needs
from cellctl.config.checks.arms.tables import table_issues, table_remarks
from cellctl.config.checks.cameras import camera_issues, camera_remarks
from cellctl.config.checks.cross_checks import unpermitted
from cellctl.config.checks.plausible.arms import arm_remarks
from cellctl.config.checks.plausible.calibration_files import calibration_file_remarks
from cellctl.config.checks.plausible.findings import plausibility_issues
from cellctl.config.checks.plausible.mounted import mounted_remarks
from cellctl.config.checks.plausible.resting import resting_issues
from cellctl.config.checks.plausible.sensors import sensor_remarks
from cellctl.config.checks.remarks import cell_remarks
from cellctl.config.issue import ConfigIssue
from cellctl.config.load import bad_devices, examine, placed, unless_named
from cellctl.config.model_file import StatedModel, model_path, stated_bases, stated_model
from cellctl.config.process_definition import process_definition
from cellctl.config.recipe import Recipe


@dataclass(frozen=True, slots=True)
class Examination:
    """Everything that is to be said of a cell file."""

    errors: tuple[ConfigIssue, ...]
    remarks: tuple[ConfigIssue, ...]
    """What may be meant as it stands; none of a file that has errors."""
    needs: tuple[ArmNeeds, ...]
    """Where each arm has to come; none of a file that has errors."""
    cell: CellConfig | None
    """The cell file; None where its keys cannot be read."""


def examine_before_commissioning(path: Path, text: str | None = None) -> Examination:
    """Errors and remarks of a cell file; touches no hardware. Raises ``ConfigUnreadable``.

    With ``text``, of the file as it would be that holds it: the model and all other files that it
    names are looked for beside ``path``.
    """
    found, cell, lines = examine(path, text)
    if cell is not None:
        found += unpermitted(cell)
        found += unless_named(found, list(_implausible(cell, path, found)))
    needs: tuple[ArmNeeds, ...] = ()
    remarks: list[ConfigIssue] = []
    if cell is not None and not found:
        needs = tuple(arm_needs(cell, path.parent))
        remarks = list(_remarks(cell, path, needs))
    return Examination(tuple(placed(found, lines)), tuple(placed(remarks, lines)), needs, cell)


def problems_before_commissioning(path: Path, text: str | None = None) -> list[ConfigIssue]:
    """The errors alone."""
    return list(examine_before_commissioning(path, text).errors)


def _implausible(cell: CellConfig, path: Path, found: list[ConfigIssue]) -> Iterator[ConfigIssue]:
    """What is possible and in all likelihood a slip."""
    bad = bad_devices(found)
    of_cell = list(plausibility_issues(cell, path.parent, bad))
    of_cell += camera_issues(cell)
    of_cell += table_issues(cell, bad)
    of_cell += box_issues(cell, stated_bases(path), bad)
    yield from of_cell
    # Not counted to what is wrong with a device: as often the box of the zone is wrong.
    yield from resting_issues(cell, bad)
    bad |= bad_devices(of_cell)
    # A device or a recipe that is wrong itself would be named a second time, by all that use it.
    if bad & {".".join(device.split(".")[:2]) for device in cell.devices()}:
        return
    for index, recipe in enumerate(cell.recipes):
        key = f"recipes.{index}"
        known = recipe.process in cell.processes
        if known and not bad & {key, f"processes.{recipe.process}"}:
            yield from _implausible_recipe(cell, recipe, key, path)


def _implausible_recipe(
    cell: CellConfig, recipe: Recipe, key: str, path: Path
) -> list[ConfigIssue]:
    definition = process_definition(recipe.process)
    found = list(definition.check_plausible(cell, recipe, key, path.parent))
    if found:
        return found  # a pose that is wrong itself would be named again, as one that sees nothing
    model = stated_model(model_path(path))
    placed_otherwise = list(definition.check_placed(cell, recipe, key, path.parent, model.bases))
    return placed_otherwise or list(definition.check_model(cell, recipe, key, model))


def model_issues(cell: CellConfig, model: StatedModel) -> Iterator[ConfigIssue]:
    """Bodies of a model that contradict a recipe of a cell file that was checked."""
    for index, recipe in enumerate(cell.recipes):
        definition = process_definition(recipe.process)
        yield from definition.check_model(cell, recipe, f"recipes.{index}", model)


def _remarks(cell: CellConfig, path: Path, needs: Iterable[ArmNeeds]) -> Iterator[ConfigIssue]:
    yield from cell_remarks(cell)
    yield from arm_remarks(cell)
    yield from mounted_remarks(cell)
    yield from sensor_remarks(cell)
    yield from camera_remarks(cell)
    yield from table_remarks(cell)
    yield from box_remarks(cell, needs)
    yield from calibration_file_remarks(cell, path.parent, utc_now())
    for index, recipe in enumerate(cell.recipes):
        definition = process_definition(recipe.process)
        yield from definition.remarks(cell, recipe, f"recipes.{index}", path.parent)
