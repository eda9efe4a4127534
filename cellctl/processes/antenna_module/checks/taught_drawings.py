"""Drawings that are other ones than those with which a stored calibration was taught.

No run starts with both. It is a remark here: the drawing may be the new one.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import cast

from cellctl.calibration.store.readable_record import readable_record
from cellctl.config.cell import CellConfig
from cellctl.config.issue import ConfigIssue
from cellctl.processes.antenna_module.drawings import read_drawings, read_plate
from cellctl.processes.antenna_module.faults.plugging import CalibrationsDoNotBelongTogether
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.settings import AntennaSettings

_CORRECTION, _REFERENCE = "plug_correction", "reference"
"""Names of stored calibrations. Their kinds are not imported: they load all solvers."""


def taught_drawing_remarks(
    cell: CellConfig, recipe: AntennaRecipe, key: str, folder: Path
) -> Iterator[ConfigIssue]:
    """One for each drawing, with all calibrations that were taught with another one."""
    drawings = read_drawings(recipe, folder)
    settings = cast(AntennaSettings, cell.processes[recipe.process])
    used = {
        "plug_drawing": drawings.plug.places_id,
        "socket_drawing": drawings.socket.places_id,
        "gripper_drawing": drawings.gripper.places_id,
    }
    written = {
        "plug_drawing": (f"{key}.plug", recipe.plug),
        "socket_drawing": (f"{key}.socket", recipe.socket),
        "gripper_drawing": (f"{key}.gripper_marks", recipe.gripper_marks),
    }
    kinds = [f"{_CORRECTION}_{recipe.id}"]
    if settings.reference is not None:
        plate, where = read_plate(settings.reference, folder), f"processes.{recipe.process}"
        used |= {
            "plate_above_drawing": plate.above.places_id,
            "plate_below_drawing": plate.below.places_id,
        }
        written |= {
            "plate_above_drawing": (
                f"{where}.reference.plate_above",
                settings.reference.plate_above,
            ),
            "plate_below_drawing": (
                f"{where}.reference.plate_below",
                settings.reference.plate_below,
            ),
        }
        kinds.append(_REFERENCE)
    taught = {kind: _made_with(cell, folder, kind) for kind in kinds}
    for name, (at, file) in written.items():
        others = [
            kind for kind, then in taught.items() if then.get(name, "") not in ("", used[name])
        ]
        if others:
            number = CalibrationsDoNotBelongTogether.number
            said = (
                f"not the drawing with which the stored {' and '.join(others)} was taught: kind, "
                "diameters, heights or places differ, and no run starts with both "
                f"(F{number}); right if the drawing was corrected since, then teach anew"
            )
            yield ConfigIssue(at, repr(file), said)


def _made_with(cell: CellConfig, folder: Path, kind: str) -> Mapping[str, str]:
    """Identities of drawings; empty where nothing is stored."""
    record = readable_record(folder / cell.calibration_dir, kind) or {}
    return cast(Mapping[str, str], record.get("made_with", {}))
