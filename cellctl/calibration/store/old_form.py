"""Files of format 1, whose id covers the record alone and not the dates and the serial number."""

from pathlib import Path

from cellctl.calibration.store.envelope import (
    StoredCalibration,
    parse_content,
    read_content,
    write_stored,
)
from cellctl.calibration.store.marker import SUFFIX
from cellctl.errors.calibration import CalibrationRecordInvalid
from cellctl.sealed_json import content_id


def seal_old_files(folder: Path) -> list[StoredCalibration]:
    """Write every file of format 1 anew in the form of today, as it is; those that there were.

    Whoever asks for this has looked at the dates and serial numbers: nothing can prove them. Raises
    ``CalibrationRecordInvalid`` for a file whose record was changed, and changes nothing then;
    ``CalibrationNotStored``.
    """
    paths = sorted(path for path in folder.glob("*.json") if not path.stem.endswith(SUFFIX))
    # All are read and checked before the first one is written, so that a changed file leaves the
    # folder as it was.
    found = [stored for path in paths if (stored := _old(path)) is not None]
    for stored in found:
        write_stored(folder, stored)
    return found


def _old(path: Path) -> StoredCalibration | None:
    content = read_content(path, path.stem)
    if not isinstance(content, dict) or "format" in content:
        return None
    stored, expected = parse_content(path, content)
    if stored.kind != path.stem or content_id(stored.record) != expected:
        raise CalibrationRecordInvalid(f"{path}: record does not match its id; it was changed")
    return stored
