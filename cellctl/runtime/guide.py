"""What a person at the cell has to know about a procedure, in sentences of the process itself."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Guide:
    """Shown before, while and after a procedure runs; nothing in the cell depends on it.

    Each sentence stands by itself: one line to read, and one to translate.
    """

    set_up: tuple[str, ...] = ()
    """What a person sees to before it starts; each is confirmed."""
    moves: tuple[str, ...] = ()
    """What will move, in the order in which it does."""
    then: tuple[str, ...] = ()
    """What is to be done when it has ended well."""
    renews: tuple[str, ...] = ()
    """Names of the calibrations that it makes."""


UNGUIDED = Guide()
"""The guide of a procedure that says nothing about itself."""
