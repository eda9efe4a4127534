"""How somebody opens the store who may read it and not write it, such as the page's process.

SQLite in WAL mode wants to write even where somebody only reads: it makes the files ``-wal`` and
``-shm`` where there are none, which is so after the daemon has ended in order. For such a reader
the database is then one that does not change, and it is told to take it so.
"""

import os
import sqlite3
from pathlib import Path
from urllib.parse import quote

from cellctl.errors.records.store import StoreUnavailable


class ReadAccess:
    """To one file, decided when it is opened. Belongs to one reader, who does not keep it long."""

    def __init__(self, file: Path) -> None:
        self._file = file
        self.writes = not file.exists() or os.access(file, os.W_OK)
        """Whether this user may write or make it; then it is opened as ever."""
        self._unchanging = not self.writes and not self._is_written()

    def connect(self, timeout_s: float, *, one_thread: bool = True) -> sqlite3.Connection:
        """A connection; raises ``sqlite3.Error``."""
        if self.writes:
            return sqlite3.connect(self._file, timeout=timeout_s, check_same_thread=one_thread)
        wanted = "mode=ro&immutable=1" if self._unchanging else "mode=ro"
        address = f"file:{quote(str(self._file.absolute()))}?{wanted}"
        return sqlite3.connect(address, timeout=timeout_s, check_same_thread=one_thread, uri=True)

    def check(self) -> None:
        """What was read is good; raises ``StoreUnavailable`` where a daemon may have written.

        It writes into the database itself only when it has a ``-wal`` file, so a read that began
        and ended without one has seen one state of it.
        """
        if self._unchanging and self._is_written():
            raise StoreUnavailable(f"{self._file}: a daemon has just opened it; ask again")

    def _is_written(self) -> bool:
        return self._file.with_name(f"{self._file.name}-wal").exists()
