"""Word that a calibration is worthless before its date, in a file beside it.

It stands until a new calibration takes the old one's place; an old file put back does not lift it.
"""

import json
from datetime import UTC, datetime
from pathlib import Path

from cellctl.atomic_files import remove_durably
from cellctl.calibration.storing import storing, write_file
from cellctl.errors.calibration import CalibrationInvalidated


def marker(folder: Path, kind: str) -> Path:
    """The file that says so."""
    return folder / f"{kind}.invalidated.json"


def mark_invalid(folder: Path, kind: str, reason: str, time: datetime) -> None:
    """Invalidate a calibration durably; the first reason stays. Raises ``CalibrationNotStored``."""
    path = marker(folder, kind)
    if path.exists():
        return
    content = {"kind": kind, "time": time.astimezone(UTC).isoformat(), "reason": reason}
    write_file(path, (json.dumps(content, indent=1) + "\n").encode())


def lift_invalidation(folder: Path, kind: str) -> None:
    """A new calibration is in place; raises ``CalibrationNotStored``."""
    path = marker(folder, kind)
    with storing(path):
        remove_durably(path)


def require_not_invalidated(folder: Path, kind: str) -> None:
    """Raise ``CalibrationInvalidated`` with time and reason; a marker needs not be readable."""
    path = marker(folder, kind)
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        words = f"{kind}: {content['reason']} ({content['time']})"
    except FileNotFoundError:
        return
    except (OSError, ValueError, LookupError, TypeError) as error:
        words = f"{kind}: {path} cannot be read: {error}"
    raise CalibrationInvalidated(words)
