"""A folder of calibrations that belongs to another cell."""

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from cellctl.config.cell import CellConfig
from cellctl.config.issue import ConfigIssue
from cellctl.config.process_definition import process_definition
from cellctl.files.hand_written import read_hand_written

_KEY = "calibration_dir"
_NAMED = 4
"""How many calibrations a message names."""


def calibration_folder_issues(cell: CellConfig, folder: Path) -> Iterator[ConfigIssue]:
    """Calibrations of other devices, and those of another part; ``folder`` is of the cell file.

    With a folder of other devices every check against calibrations is passed over, and each
    procedure stores its result among those of the other cell. What belongs to another part is
    taken at the first run: a contact is planned by the stiffness of another tool. A folder without
    calibrations is that of a cell which is still to be calibrated.
    """
    known = _known(cell)
    if not cell.calibration_dir.strip() or not known or not all(known.values()):
        return  # a process of another package need not say what it stores
    if any(recipe.process not in known for recipe in cell.recipes):
        return  # its section is wrong itself, and what it stores is not known without
    names = [name for of_process in known.values() for name in of_process]
    place = folder / cell.calibration_dir
    stored = _stored(place)
    ours = [one for one in stored if _is_of(one, names)]
    if stored and not ours:
        allowed = (
            f"a folder with {_listed(names)} of this cell, or one that has no calibration yet; "
            f"this one has none of them, and has {_listed(stored)}: it is another cell's"
            f"{_meant(cell, folder, names)}"
        )
        yield ConfigIssue(_KEY, repr(cell.calibration_dir), allowed)
        return
    yield from _of_another_part(cell, folder, known, ours)


def _of_another_part(
    cell: CellConfig, folder: Path, known: dict[str, tuple[str, ...]], ours: list[str]
) -> Iterator[ConfigIssue]:
    """A folder that a cell file beside this one has for another part of the same number."""
    for recipe in cell.recipes:
        ending = f"_{recipe.id}"
        own = [one for one in ours if one.endswith(ending)]
        own = [one for one in own if one.removesuffix(ending) in known.get(recipe.process, ())]
        for file, other in _beside(cell, folder) if own else ():
            for part in _recipes(other):
                same = part.get("process") == recipe.process and part.get("id") == recipe.id
                if same and part.get("name") != recipe.name:
                    names = [name for of_process in known.values() for name in of_process]
                    meant = _meant(cell, folder, names)
                    allowed = (
                        f"another folder than that of {file}: {_listed(own)} holds for the part of "
                        f"one recipe, and recipe {recipe.id} is {part.get('name')!r} there and "
                        f"{recipe.name!r} here; or take {file} away, if it is an older copy of "
                        f"this one{meant}"
                    )
                    yield ConfigIssue(_KEY, repr(cell.calibration_dir), allowed)
                    return


def _known(cell: CellConfig) -> dict[str, tuple[str, ...]]:
    return {name: process_definition(name).stores for name in cell.processes}


def _stored(place: Path) -> list[str]:
    return sorted(one.stem for one in place.glob("*.json"))


def _is_of(stored: str, names: list[str]) -> bool:
    """Whether a file holds one of these calibrations, be it of a single recipe."""
    start, _, recipe = stored.rpartition("_")
    return stored in names or (recipe.isdecimal() and start in names)


def _listed(names: list[str]) -> str:
    return ", ".join(names[:_NAMED]) + (", ..." if len(names) > _NAMED else "")


def _meant(cell: CellConfig, folder: Path, names: list[str]) -> str:
    """The folders beside it that hold calibrations of this cell; those first that no other cell
    file names."""
    place = folder / cell.calibration_dir
    if not place.parent.is_dir():
        return ""
    taken = {(folder / str(other.get(_KEY))).resolve() for _, other in _files(folder)}
    fitting = [
        one
        for one in sorted(place.parent.iterdir())
        if one.resolve() != place.resolve() and any(_is_of(name, names) for name in _stored(one))
    ]
    free = [one for one in fitting if one.resolve() not in taken]
    meant = " or ".join(
        repr(str(Path(cell.calibration_dir).parent / one.name)) for one in free or fitting
    )
    return f"; did you mean {meant}?" if meant else ""


def _beside(cell: CellConfig, folder: Path) -> Iterator[tuple[str, dict[str, Any]]]:
    """Cell files beside this one that name the same folder."""
    place = (folder / cell.calibration_dir).resolve()
    for file, other in _files(folder):
        if (folder / str(other[_KEY])).resolve() == place:
            yield file, other


def _files(folder: Path) -> Iterator[tuple[str, dict[str, Any]]]:
    """Cell files, as far as they can be read; what is wrong with them, their own check says."""
    for path in sorted(folder.glob("*.toml")):
        try:
            text = read_hand_written(path)
            # Most files beside a cell file are drawings and models.
            raw = tomllib.loads(text) if _KEY in text else {}
        except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
            continue
        if _KEY in raw:
            yield path.name, raw


def _recipes(raw: dict[str, Any]) -> list[dict[str, Any]]:
    found = raw.get("recipes", [])
    return [one for one in found if isinstance(one, dict)] if isinstance(found, list) else []
