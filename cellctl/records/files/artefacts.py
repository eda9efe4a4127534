"""Files beside the database, each under the SHA-256 of its bytes: written once, never changed."""

import hashlib
from pathlib import Path

from cellctl.errors.records.store import ArtefactDamaged, RecordNotWritten
from cellctl.files.atomic_files import write_durably

CELL_FILE = "cell.json"
"""Name of the artefact with the cell file that a run was made with."""


class ArtefactFolder:
    """A folder of files by content."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def path(self, sha256: str) -> Path:
        """Path of the file whose bytes have this hash."""
        # The first two digits spread the files over 256 folders, which stay small enough to be
        # listed.
        return self._folder / sha256[:2] / sha256

    def put(self, data: bytes) -> str:
        """Store bytes durably and return their hash; raises ``RecordNotWritten``."""
        sha256 = hashlib.sha256(data).hexdigest()
        path = self.path(sha256)
        try:
            # Written once: the same bytes have the same name. A file of another length is damaged
            # and is written anew.
            if not (path.exists() and path.stat().st_size == len(data)):
                write_durably(path, data)
        except OSError as error:
            raise RecordNotWritten(f"{path.name}: {error.strerror}") from error
        return sha256

    def get(self, sha256: str) -> bytes:
        """The bytes; raises ``ArtefactDamaged`` when they are missing or others."""
        try:
            data = self.path(sha256).read_bytes()
        except OSError as error:
            raise ArtefactDamaged(f"{sha256[:12]}: {error.strerror}") from error
        # Read back and compared, so that a damaged disk or a changed file is a fault and never a
        # result.
        if hashlib.sha256(data).hexdigest() != sha256:
            raise ArtefactDamaged(f"{sha256[:12]}: content does not match its name")
        return data
