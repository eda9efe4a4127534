"""Whether the disk takes a record: asked before anything moves, and while something does."""

import os
import shutil
from pathlib import Path

from cellctl.errors.records.store import DiskNearlyFull, RecordNotWritten, StoreUnavailable

LEAST_FREE_BYTES = 2 * 1024**3
"""A run with its raw images takes some 0.15 GB. The rest is for the log and for the next hours, in
which somebody makes room."""

PROBE = "probe"
"""A file of the store's folder that belongs to no record."""


def require_space(folder: Path) -> None:
    """Raise ``DiskNearlyFull`` when less than ``LEAST_FREE_BYTES`` are free for this user."""
    try:
        free = shutil.disk_usage(folder).free
    except OSError as error:
        raise StoreUnavailable(f"{folder}: {error.strerror}") from error
    if free < LEAST_FREE_BYTES:
        raise DiskNearlyFull(
            f"{free / 1e9:.1f} GB free on the disk of {folder}, needed {LEAST_FREE_BYTES / 1e9:.1f}"
        )


def require_writable(folder: Path) -> None:
    """Have a few bytes reach the disk; raises ``RecordNotWritten`` when they do not."""
    try:
        with (folder / PROBE).open("wb") as probe:
            probe.write(b"cellctl\n")
            probe.flush()
            os.fsync(probe.fileno())
    except OSError as error:
        raise RecordNotWritten(f"{folder}: {error.strerror}") from error
