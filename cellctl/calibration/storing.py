"""Writing into the folder of calibrations, and the fault when that fails."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from cellctl.atomic_files import write_durably
from cellctl.errors.calibration import CalibrationNotStored


@contextmanager
def storing(path: Path) -> Iterator[None]:
    """Raise ``CalibrationNotStored`` for an ``OSError`` inside."""
    try:
        yield
    except OSError as error:
        raise CalibrationNotStored(f"{path}: {error.strerror or error}") from error


def write_file(path: Path, data: bytes) -> None:
    """A file of the folder, durably; raises ``CalibrationNotStored``."""
    with storing(path):
        write_durably(path, data)
