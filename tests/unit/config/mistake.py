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
    features: tuple[str, ...] = ()
    """The feature files in which it stands, where it is not in the cell file."""
    at_the_other: bool = False
    """Whether, of two keys that contradict each other, the one that was not changed is named."""


def deck(old: str, new: str, key: str, said: str) -> Mistake:
    """A mistake in the cell file of the fake cell."""
    return Mistake("deck.toml", old, new, key, said)


def deck_elsewhere(old: str, new: str, key: str, said: str) -> Mistake:
    """The same, named at the key that it contradicts."""
    return Mistake("deck.toml", old, new, key, said, at_the_other=True)


def drawn(features: tuple[str, ...], old: str, new: str, said: str) -> Mistake:
    """A mistake in feature files of the fake cell, told at the key that names the first of them."""
    part = features[0].split(".")[0]
    return Mistake("deck.toml", old, new, f"recipes.0.{part}_features", said, features)


@dataclass(frozen=True, slots=True)
class Undecided:
    """What is no error: the cell file cannot say whether it was meant."""

    mistake: Mistake
    """``said`` is part of a remark; empty where there is nothing to hold it against."""
    reason: str
