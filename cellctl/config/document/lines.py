"""Finds the line of a TOML file in which a key stands.

``tomllib`` keeps no lines, so tables and keys are looked for in the text. The text is known to be
TOML; what is not understood here only leaves a finding without its line.
"""

import re
from collections import Counter
from collections.abc import Mapping

_TABLE = re.compile(r"^\s*(\[\[?)\s*([^\[\]]+?)\s*\]\]?\s*(#.*)?$")
_WORD = r"""(?:[\w-]+|"[^"]*"|'[^']*')"""
_KEY = re.compile(rf"^\s*({_WORD}(?:\s*\.\s*{_WORD})*)\s*=\s*(.*)$")
_INLINE = re.compile(r"([\w-]+)\s*=")
_COMMENT_OR_TEXT = re.compile(r"""("(?:[^"\\]|\\.)*"|'[^']*')|#.*$""")
FILL_IN = "FILL IN"
_COMMENTED_KEY = re.compile(rf"^#\s*(?={_WORD}\s*=\s)", re.MULTILINE)
"""What stands before a key that a template offers in a comment."""


def key_lines(text: str) -> dict[str, int]:
    """Line of every table and key, by its path as findings write it (``recipes.0.name``)."""
    lines: dict[str, int] = {}
    arrays: Counter[str] = Counter()
    table, depth = "", 0
    for number, line in enumerate(text.splitlines(), 1):
        bare = _without_text(line)
        if depth == 0 and (match := _TABLE.match(line)):
            table = _table_path(match[1], _plain(match[2]), arrays)
            lines.setdefault(table, number)
            # [robots.arm.settings] without [robots.arm] before it: the device begins here.
            lines.setdefault(".".join(table.split(".")[:2]), number)
            continue
        if depth == 0 and (match := _KEY.match(line)):
            path = ".".join(part for part in (table, _plain(match[1])) if part)
            lines.setdefault(path, number)
            for inner in _INLINE.findall(_without_text(match[2])):
                lines.setdefault(f"{path}.{inner}", number)
        depth += sum(bare.count(sign) for sign in "[{") - sum(bare.count(sign) for sign in "]}")
    return lines


def line_of(key: str, lines: dict[str, int]) -> int | None:
    """Line of a key, or of the table that lacks it; None for one that the file does not have."""
    parts = key.split(".")
    for length in range(len(parts), 0, -1):
        if (found := lines.get(".".join(parts[:length]))) is not None:
            return found
    return None


def left_open(text: str) -> dict[int, str]:
    """Lines in which a template still says FILL IN, in a comment or a value, and what each is of.

    That is the key or table of the line itself, of the next one below a comment, given or offered
    in a comment too, or the one whose value goes on in the line. The line of a template that
    explains the mark does not count as one.
    """
    first: dict[int, str] = {}
    for key, number in key_lines(_COMMENTED_KEY.sub("", text)).items():
        # A table is met before the device that begins with it, a key before those in its value.
        first.setdefault(number, key)
    return {
        number: _of_mark(number, line, first)
        for number, line in enumerate(text.splitlines(), 1)
        if FILL_IN in line and "marked FILL IN" not in line
    }


def _of_mark(number: int, line: str, first: Mapping[int, str]) -> str:
    """Empty in a file without any key."""
    below = [one for one in first if one >= number]
    above = [one for one in first if one < number]
    if number not in first and (not line.lstrip().startswith("#") or not below):
        return first[max(above)] if above else ""
    return first[min(below)]


def _plain(path: str) -> str:
    return ".".join(part.strip().strip("\"'") for part in path.split("."))


def _table_path(opening: str, path: str, arrays: Counter[str]) -> str:
    # A table below an array of tables belongs to the newest entry of that array.
    for array, count in arrays.items():
        if path.startswith(f"{array}."):
            return f"{array}.{count - 1}{path[len(array) :]}"
    if opening == "[[":
        arrays[path] += 1
        return f"{path}.{arrays[path] - 1}"
    return path


def _without_text(line: str) -> str:
    """The line without comments and quoted text, whose brackets open nothing."""
    return _COMMENT_OR_TEXT.sub("", line)
