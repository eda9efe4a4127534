"""Writing the files that commands are asked for."""

from pathlib import Path

from cellctl.errors.config import OutputNotWritten
from cellctl.files.atomic_files import write_durably


def write_file(path: Path, content: bytes) -> None:
    """Write a result, whole or not at all; raises ``OutputNotWritten`` with the reason."""
    try:
        write_durably(path, content)
    except OSError as error:
        raise OutputNotWritten(f"{path}: {error.strerror or error}") from error
