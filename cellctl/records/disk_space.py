"""Room on the disk for a record, asked before anything moves."""

import shutil
from pathlib import Path

from cellctl.errors.records import DiskNearlyFull, StoreUnavailable

LEAST_FREE_BYTES = 2 * 1024**3
"""A run with its raw images takes some 0.15 GB. The rest is for the log and for the next hours, in
which somebody makes room."""


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
