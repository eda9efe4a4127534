"""How a run ended whose end the database did not take: a small file beside it until the next start.

A store that has failed takes nothing more before it is opened anew. The daemon knows all the same
why the run ended, and its record must not say that nobody does.
"""

import json
from dataclasses import asdict, dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

from cellctl.errors.records.store import RecordNotWritten
from cellctl.files.atomic_files import write_durably
from cellctl.records.entries import RunResult

_SUFFIX = ".end.json"


@dataclass(frozen=True, slots=True)
class UnwrittenEnd:
    """What the record is closed with at the next start. Never good: the line was told ABORTED."""

    ended: datetime
    result: RunResult
    fault_number: int
    fault: str

    @classmethod
    def from_json(cls, content: Any) -> "UnwrittenEnd":
        """Raises ``ValueError``, ``LookupError`` or ``TypeError`` for anything else."""
        result, ended = RunResult(content["result"]), datetime.fromisoformat(content["ended"])
        if result is RunResult.GOOD or ended.tzinfo is None:
            raise ValueError("no end of a run that could not be recorded")
        return cls(ended, result, int(content["fault_number"]), str(content["fault"]))


class UnwrittenEnds:
    """A folder with one file for each such run."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def keep(self, run: int, end: UnwrittenEnd) -> None:
        """Keep the end of a run; it is on the disk when this returns. Raises
        ``RecordNotWritten``."""
        content = asdict(end) | {"ended": end.ended.isoformat(), "result": end.result.value}
        try:
            write_durably(self._path(run), (json.dumps(content) + "\n").encode())
        except OSError as error:
            raise RecordNotWritten(f"end of run {run}: {error.strerror}") from error

    def read(self, run: int) -> UnwrittenEnd | None:
        """None where there is none that can be read."""
        try:
            return UnwrittenEnd.from_json(json.loads(self._path(run).read_text(encoding="utf-8")))
        except (OSError, ValueError, LookupError, TypeError):
            return None

    def clear(self) -> None:
        """Remove all of them: no run is open. Raises ``RecordNotWritten``."""
        try:
            # A crash while one was written has left its draft.
            for path in self._folder.glob(f"*{_SUFFIX}*"):
                path.unlink(missing_ok=True)
        except OSError as error:
            raise RecordNotWritten(f"{self._folder}: {error.strerror}") from error

    def _path(self, run: int) -> Path:
        return self._folder / f"{run}{_SUFFIX}"
