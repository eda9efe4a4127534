"""What was looked at, what was found, and what to do about it."""

from dataclasses import dataclass
from enum import StrEnum


class Health(StrEnum):
    """How much it hinders the cell."""

    GOOD = "good"
    DOUBTFUL = "doubtful"
    """The cell runs, but not as well or not as surely as it could."""
    BAD = "bad"
    """The service does not start, or not everything of the cell is reached."""


@dataclass(frozen=True, slots=True)
class Finding:
    """One line of the diagnosis; ``remedy`` is empty for what is good."""

    subject: str
    health: Health
    found: str
    remedy: str = ""


def good(subject: str, found: str) -> Finding:
    """Nothing to do."""
    return Finding(subject, Health.GOOD, found)


def doubtful(subject: str, found: str, remedy: str) -> Finding:
    """Better done before production."""
    return Finding(subject, Health.DOUBTFUL, found, remedy)


def bad(subject: str, found: str, remedy: str) -> Finding:
    """Something that has to be mended before the service can run."""
    return Finding(subject, Health.BAD, found, remedy)
