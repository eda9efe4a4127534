"""Recordings of runs that are still open: files that a daemon which dies leaves behind."""

from pathlib import Path
from typing import BinaryIO

from cellctl.atomic_files import make_folder_durably
from cellctl.errors.records import RecordNotWritten

MOTION = "motion.mcap"
"""Name of a recording among the files of its run."""


class UnfinishedRecordings:
    """A folder with one file for each open run. Methods raise ``RecordNotWritten``.

    Not made durable: what a crash of the daemon leaves is in the memory of the kernel, and waiting
    for the disk twice a second would disturb what has to be stored.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def open(self, run: int) -> BinaryIO:
        """A new file for a run."""
        try:
            make_folder_durably(self._folder)
            return self._path(run).open("wb")
        except OSError as error:
            raise RecordNotWritten(f"recording of run {run}: {error.strerror}") from error

    def read(self, run: int) -> bytes | None:
        """What the file of a run holds so far; None when there is none."""
        try:
            return self._path(run).read_bytes()
        except FileNotFoundError:
            return None
        except OSError as error:
            raise RecordNotWritten(f"recording of run {run}: {error.strerror}") from error

    def remove(self, run: int) -> None:
        """Of a run whose recording stands in its record, or will never be one."""
        try:
            self._path(run).unlink(missing_ok=True)
        except OSError as error:
            raise RecordNotWritten(f"recording of run {run}: {error.strerror}") from error

    def clear(self) -> None:
        """Remove the files of all runs: no run is open."""
        for path in self._folder.glob("*.mcap"):
            self.remove(int(path.stem))

    def _path(self, run: int) -> Path:
        return self._folder / f"{run}.mcap"
