"""Ship the calibrations that a demonstration has made: `python -m fakes.demo.ship RUN FOLDER`.

Fake devices do not age: their hardware seed draws them alike for ever, so what was measured of them
never expires. A real calibration never gets such a date.
"""

import hashlib
import json
import shutil
from pathlib import Path
from typing import Annotated

import typer

NEVER = "9999-12-31T00:00:00+00:00"


def ship(
    run: Annotated[Path, typer.Argument(help="Folder of a `demo --calibrate`.")],
    folder: Annotated[Path, typer.Argument(help="Where the cell file looks for calibrations.")],
) -> None:
    """Copy calibrations and pictures of a demonstration, without their last day."""
    made = run / "calibration"
    folder.mkdir(parents=True, exist_ok=True)
    for file in sorted(made.glob("*.json")):
        if file.name.endswith(".invalidated.json"):
            continue
        content = json.loads(file.read_text(encoding="utf-8"))
        content |= {"valid_until": NEVER}
        content |= {"id": _identity(content)}
        (folder / file.name).write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
        typer.echo(f"{folder / file.name}")
    for picture in sorted(made.glob("*.png")):
        shutil.copyfile(picture, folder / picture.name)


def _identity(content: dict[str, object]) -> str:
    """SHA-256 of everything but the id, in canonical JSON: docs/calibration.md."""
    plain = {key: value for key, value in content.items() if key != "id"}
    text = json.dumps(plain, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


if __name__ == "__main__":
    typer.run(ship)
