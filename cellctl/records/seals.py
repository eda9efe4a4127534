"""Where the hash chain of the store holds a run, and where it ends."""

from dataclasses import dataclass
from datetime import datetime


@dataclass(frozen=True, slots=True)
class Seal:
    """The run's place in the hash chain."""

    number: int
    time: datetime
    content: str
    previous: str
    hash: str


@dataclass(frozen=True, slots=True)
class LedgerHead:
    """Where the hash chain ends."""

    length: int
    """Number of the newest entry; 0 in an empty store."""
    hash: str
    """Hash of that entry."""

    def __str__(self) -> str:
        return f"{self.length}:{self.hash}"
