"""A lock by which one daemon owns a store; it ends with the daemon's process."""

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from cellctl.errors.records.store import StoreHeldByEarlierVersion, StoreInUse


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

    @contextmanager
    def alone(self) -> Iterator[None]:
        """No daemon works with the store inside the block; raises ``StoreHeldByEarlierVersion``.

        For a migration: one that lives through it would go on writing the form that it knows.
        """
        try:
            self.take()
        except StoreInUse as error:
            raise StoreHeldByEarlierVersion(error.detail) from error
        try:
            yield
        finally:
            self.release()

    def release(self) -> None:
        """Give the store up. Idempotent."""
        if self._file is not None:
            self._file.close()
            self._file = None
