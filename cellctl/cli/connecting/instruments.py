"""Serial numbers that have answered, held against those that the calibrations were made for."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from cellctl.calibration.store.envelope import read_stored
from cellctl.calibration.store.kind import Kinds
from cellctl.cli.connecting.answer import Answer
from cellctl.config import CellConfig
from cellctl.config.process_definition import process_definition
from cellctl.config.recipe import Recipe
from cellctl.errors import CellError
from cellctl.runtime.process import Process


def with_instruments(cell: CellConfig, folder: Path, answers: Iterable[Answer]) -> list[Answer]:
    """The answers, each with the calibrations that were made for another device.

    ``folder`` holds the calibrations. One that is missing or damaged is no matter of a device: the
    daemon says so.
    """
    differs: dict[str, list[str]] = {}
    by_path = {answer.path: answer for answer in answers}
    for recipe in cell.recipes:
        for path, text in _of_recipe(recipe, folder, by_path):
            if text not in differs.setdefault(path, []):
                differs[path].append(text)
    return [
        replace(answer, differs=(*answer.differs, *differs.get(path, ())))
        for path, answer in by_path.items()
    ]


def _of_recipe(
    recipe: Recipe, folder: Path, answers: Mapping[str, Answer]
) -> Iterator[tuple[str, str]]:
    definition = process_definition(recipe.process)
    kinds: Kinds = definition.calibration_kinds() if issubclass(definition, Process) else ()
    trackers = [role for role, what in definition.roles.items() if what.section == "trackers"]
    for kind in kinds:
        # A result that belongs to no device was measured with a tracker, if with any.
        role = kind.device or (trackers[0] if len(trackers) == 1 else None)
        if role is None:
            continue
        path = f"{definition.roles[role].section}.{recipe.device(role)}"
        name = kind.for_recipe(recipe.id).name
        found = answers.get(path)
        made_for = _made_for(folder, name)
        if found is None or found.fault is not None or made_for is None:
            continue
        measured = kind.device is not None or made_for != ""
        if measured and made_for != found.serial_number:
            text = f"calibration {name} was made for {made_for!r}, connected is "
            yield path, text + repr(found.serial_number)


def _made_for(folder: Path, name: str) -> str | None:
    try:
        return read_stored(folder, name).serial_number
    except CellError:
        return None
