"""Writes files of the calibration folder; a failure of the disk becomes a numbered fault."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from cellctl.errors.calibration import CalibrationNotStored
from cellctl.files.atomic_files import write_durably


@contextmanager
def raising_not_stored(path: Path) -> Iterator[None]:
    """Raise ``CalibrationNotStored`` for an ``OSError`` inside."""
    try:
        yield
    except OSError as error:
        raise CalibrationNotStored(f"{path}: {error.strerror or error}") from error


def write_file(path: Path, data: bytes) -> None:
    """Write a file of the folder durably; raises ``CalibrationNotStored``."""
    with raising_not_stored(path):
        write_durably(path, data)
