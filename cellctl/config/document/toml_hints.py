"""What is probably wrong with a line that is not TOML, in words."""

import re
from collections.abc import Iterator

_PLACE = re.compile(r"at line (\d+)")
_SLIPS = (
    (re.compile(r"=\s*-?\d+,\d+\s*(#.*)?$"), "a decimal comma: TOML has a point, {fixed}"),
    (re.compile(r"[“”„‘’]"), "quotes of a text program: TOML has \" or '"),
    (re.compile(r"=\s*(True|False)\b"), "true and false are written small"),
    (re.compile(r"^\s*[\w.-]+\s*:\s"), "a colon: TOML has = between key and value"),
    (
        re.compile(r"^\s*[\w.-]+\s*=\s*[A-Za-z_/][\w./ -]*(#.*)?$"),
        'a text without quotes: TOML has " round it',
    ),
)
"""Each with what it says; ``{fixed}`` is the line with a point."""


def toml_hint(text: str, error: str) -> str:
    """``; line 3 'x = 10,0': a decimal comma …`` for the line of an error, else nothing."""
    if (place := _PLACE.search(error)) and "overwrite" in error:
        return f"; {_above(text.splitlines(), int(place[1]))}"
    for number, line in _suspects(text, error):
        for slip, words in _SLIPS:
            if slip.search(line):
                fixed = re.sub(r"(\d),(\d)", r"\1.\2", line.split("#")[0]).strip()
                shown = line.strip()
                return f"; line {number} '{shown}': {words.format(fixed=fixed)}"
    return ""


def _above(lines: list[str], number: int) -> str:
    """Says in which line the key or table of a line stands for the first time."""
    name = lines[number - 1].split("=")[0].split("#")[0].strip()
    for earlier in range(number - 1, 0, -1):
        if lines[earlier - 1].split("=")[0].split("#")[0].strip() == name:
            return f"{name} stands in line {earlier} already; one of both goes"
    return f"{name} is there already"


def _suspects(text: str, error: str) -> Iterator[tuple[int, str]]:
    """The line that the error names, and the one before, which may not have ended."""
    place = _PLACE.search(error)
    if place is None:
        return
    lines = text.splitlines()
    for number in (int(place[1]), int(place[1]) - 1):
        if 1 <= number <= len(lines):
            yield number, lines[number - 1]
