"""Outcomes on the disk: an interrupted campaign goes on where it stopped."""

import json
from pathlib import Path

from benchmarks.tornado.cases import Case
from benchmarks.tornado.outcome import Outcome


class Ledger:
    """Outcomes by case, in one file that is replaced as a whole after every run."""

    def __init__(self, path: Path) -> None:
        """Reads what is there; raises ``ValueError`` for a file of something else."""
        self._path = path
        self.outcomes: list[Outcome] = []
        if path.exists():
            try:
                rows = json.loads(path.read_text(encoding="utf-8"))
                self.outcomes = [Outcome.of(row) for row in rows]
            except (ValueError, TypeError, KeyError) as error:
                raise ValueError(f"{path} holds no outcomes of this campaign: {error}") from error

    def has(self, case: Case) -> bool:
        """True when this very case was run already."""
        return any(outcome.case == case for outcome in self.outcomes)

    def add(self, outcome: Outcome) -> None:
        """Keep an outcome."""
        self.outcomes.append(outcome)
        rows = [one.row() for one in self.outcomes]
        partial = self._path.with_suffix(".partial")
        partial.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
        partial.replace(self._path)
