"""A lock by which one daemon owns a store; it ends with the daemon's process."""

import fcntl
from pathlib import Path
from typing import IO

from cellctl.errors.records import StoreInUse


class Ownership:
    """An advisory lock on a file beside the database."""

    def __init__(self, file: Path) -> None:
        self._path = file
        self._file: IO[str] | None = None

    def take(self) -> None:
        """Own the store from now on; raises ``StoreInUse``. Idempotent."""
        if self._file is not None:
            return
        file = self._path.open("w", encoding="ascii")
        try:
            # The kernel releases it however the process ends, so no stale lock keeps the next start
            # from its store.
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            file.close()
            raise StoreInUse(str(self._path.parent)) from error
        self._file = file

    def release(self) -> None:
        """Give the store up. Idempotent."""
        if self._file is not None:
            self._file.close()
            self._file = None
