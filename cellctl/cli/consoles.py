"""Terminals on which text is text.

Serial numbers, names, remarks and the words of faults are what people and devices say. Rich would
take ``[x]`` in them for mark-up and ``:100:`` for a picture, and print neither.
"""

from rich.console import Console


def console_of_lines(*, stderr: bool = False) -> Console:
    """One line for each thing, however wide: scripts read them, and numbers need no colours."""
    return Console(stderr=stderr, soft_wrap=True, highlight=False, markup=False, emoji=False)


def console_of_tables() -> Console:
    """Tables as wide as the terminal. What is coloured in them has a style, and no mark-up."""
    return Console(markup=False, emoji=False)
