"""One mistake in a cell file."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Mistake:
    """One replacement in a cell file; ``said`` is part of what `cellctl check` must say."""

    file: str
    old: str
    new: str
    key: str
    said: str
    at_the_other: bool = False
    """Of two keys that contradict each other, the one that was not changed is named."""
