"""Terminals on which text is text.

Serial numbers, names, remarks and the words of faults are what people and devices say. Rich would
take ``[x]`` in them for mark-up and ``:100:`` for a picture, and print neither.
"""

import re

from rich.cells import cell_len
from rich.console import Console

from cellctl.errors import CellError

_LEAST_TEXT = 30
"""A column of text that is narrower is harder to read than one that begins farther to the left."""
_PIECES = re.compile(r"\s*[（《]*(?:[\u2e80-\uffff][，。；：、）》]*|[^\s\u2e80-\uffff]+)")
"""Between these a line may end: words, or single characters of Chinese with brackets and stops."""


def console_of_lines(*, stderr: bool = False) -> Console:
    """One line for each thing, however wide: scripts read them, and numbers need no colours."""
    return Console(stderr=stderr, soft_wrap=True, highlight=False, markup=False, emoji=False)


def console_of_tables() -> Console:
    """Tables as wide as the terminal. What is coloured in them has a style, and no mark-up."""
    return Console(markup=False, emoji=False)


def print_hanging(console: Console, text: str, indent: int, style: str | None = None) -> None:
    """One thing, on a terminal in lines as wide as that, those after the first this far in.

    For a program that reads the output it stays one line.
    """
    if console.is_terminal:
        text = hanging(text, console.width, indent)
    console.print(text, style=style)


def print_refusal(fault: CellError) -> None:
    """A fault with which a command ends by an exit code of its own, on standard error."""
    console = console_of_lines(stderr=True)
    print_hanging(console, str(fault), 5)
    print_hanging(console, f"  {fault.remedy}", 2)


def print_warning(words: str) -> None:
    """What a command has to say beside its result, on standard error."""
    print_hanging(console_of_lines(stderr=True), f"warning: {words}", 9)


def hanging(text: str, width: int, indent: int) -> str:
    """Lines of at most this width; addresses, names and keys stay whole."""
    margin = " " * max(0, min(indent, width - _LEAST_TEXT))
    lines = [""]
    for piece in _PIECES.findall(text):
        if lines[-1].strip() and cell_len(lines[-1] + piece) > width:
            lines.append(margin + piece.lstrip())
        else:
            lines[-1] += piece
    return "\n".join(lines)
