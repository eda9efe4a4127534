"""Finds the line of a TOML file in which a key stands.

``tomllib`` keeps no lines, so tables and keys are looked for in the text. The text is known to be
TOML; what is not understood here only leaves a finding without its line.
"""

import re
from collections import Counter

_TABLE = re.compile(r"^\s*(\[\[?)\s*([^\[\]]+?)\s*\]\]?\s*(#.*)?$")
_WORD = r"""(?:[\w-]+|"[^"]*"|'[^']*')"""
_KEY = re.compile(rf"^\s*({_WORD}(?:\s*\.\s*{_WORD})*)\s*=\s*(.*)$")
_INLINE = re.compile(r"([\w-]+)\s*=")
_COMMENT_OR_TEXT = re.compile(r"""("(?:[^"\\]|\\.)*"|'[^']*')|#.*$""")
FILL_IN = "FILL IN"


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


def left_open(text: str) -> list[int]:
    """Lines in which a template still says FILL IN, in a comment or a value.

    The first line of a template explains the mark and does not count as one.
    """
    return [
        number
        for number, line in enumerate(text.splitlines(), 1)
        if FILL_IN in line and "marked FILL IN" not in line
    ]


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
