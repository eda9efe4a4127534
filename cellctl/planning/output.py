"""Writes the files that `cellctl plan` makes."""

from pathlib import Path

from cellctl.atomic_files import write_durably
from cellctl.errors.config import OutputNotWritten


def write_output(out: Path, data: bytes) -> None:
    """Whole or not at all; raises ``OutputNotWritten``."""
    try:
        write_durably(out, data)
    except OSError as error:
        raise OutputNotWritten(f"{out}: {error.strerror or error}") from error
