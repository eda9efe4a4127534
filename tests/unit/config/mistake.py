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


def deck(old: str, new: str, key: str, said: str) -> Mistake:
    """A mistake in the cell file of the fake cell."""
    return Mistake("deck.toml", old, new, key, said)


def deck_elsewhere(old: str, new: str, key: str, said: str) -> Mistake:
    """The same, named at the key that it contradicts."""
    return Mistake("deck.toml", old, new, key, said, at_the_other=True)
