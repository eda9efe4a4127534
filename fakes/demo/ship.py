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
    texts = {
        file.name: file.read_text(encoding="utf-8")
        for file in sorted(made.glob("*.json"))
        if not file.name.endswith(".invalidated.json")
    }
    for name, text in _without_last_day(texts).items():
        (folder / name).write_text(text, encoding="utf-8")
        typer.echo(f"{folder / name}")
    for picture in sorted(made.glob("*.png")):
        shutil.copyfile(picture, folder / picture.name)


def _without_last_day(texts: dict[str, str]) -> dict[str, str]:
    """Files by name that never expire, with identities of their own.

    A calibration that was made with others names them by their identities, which change as well:
    those are done first.
    """
    ids = {name: str(json.loads(text)["id"]) for name, text in texts.items()}
    done: dict[str, str] = {}
    while len(done) < len(texts):
        waiting = [name for name in texts if name not in done]
        ready = [
            name
            for name in waiting
            if not any(ids[other] in texts[name] for other in waiting if other != name)
        ]
        if not ready:
            raise ValueError(f"these calibrations name each other: {', '.join(waiting)}")
        for name in ready:
            text = texts[name]
            for other, shipped in done.items():
                text = text.replace(ids[other], str(json.loads(shipped)["id"]))
            content = json.loads(text) | {"valid_until": NEVER}
            content |= {"id": _identity(content)}
            done[name] = json.dumps(content, indent=1) + "\n"
    return done


def _identity(content: dict[str, object]) -> str:
    """SHA-256 of everything but the id, in canonical JSON: docs/calibration.md."""
    plain = {key: value for key, value in content.items() if key != "id"}
    text = json.dumps(plain, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


if __name__ == "__main__":
    typer.run(ship)
