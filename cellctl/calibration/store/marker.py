"""The marker ``<kind>.invalidated.json``: this calibration is invalid before its date.

The marker is a file of its own so that it stays when somebody copies an old calibration back. Only
a calibration that was made anew removes it.
"""

import json
from datetime import UTC, datetime
from pathlib import Path

from cellctl.calibration.store.calibration_io import raising_not_stored, write_file
from cellctl.errors.calibration import CalibrationInvalidated
from cellctl.files.atomic_files import remove_durably

SUFFIX = ".invalidated"


def marker(folder: Path, kind: str) -> Path:
    """Path of the marker that says that a kind was invalidated."""
    return folder / f"{kind}{SUFFIX}.json"


def marked(folder: Path) -> list[str]:
    """Names of all calibrations that were invalidated, sorted; also where only the marker is left.

    Never raises.
    """
    return sorted(file.stem.removesuffix(SUFFIX) for file in folder.glob(f"*{SUFFIX}.json"))


def mark_invalid(folder: Path, kind: str, reason: str, time: datetime) -> None:
    """Invalidate a calibration durably; raises ``CalibrationNotStored``.

    The first reason stays: later ones are mostly consequences of it.
    """
    path = marker(folder, kind)
    if path.exists():
        return
    content = {"kind": kind, "time": time.astimezone(UTC).isoformat(), "reason": reason}
    write_file(path, (json.dumps(content, indent=1) + "\n").encode())


def lift_invalidation(folder: Path, kind: str) -> None:
    """Remove the marker because a new calibration is in place; raises ``CalibrationNotStored``."""
    path = marker(folder, kind)
    with raising_not_stored(path):
        remove_durably(path)


def require_not_invalidated(folder: Path, kind: str) -> None:
    """Raise ``CalibrationInvalidated`` with time and reason when there is a marker."""
    path = marker(folder, kind)
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        words = f"{kind}: {content['reason']} ({content['time']})"
    except FileNotFoundError:
        return
    except (OSError, ValueError, LookupError, TypeError) as error:
        # Somebody has invalidated the calibration, even if the reason is lost: never use it.
        words = f"{kind}: {path} cannot be read: {error}"
    raise CalibrationInvalidated(words)
