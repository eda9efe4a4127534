"""Lines of a job file as tokens (reference: ANTLR grammar "Job", RC 5.0, and its tree-sitter port).

The public grammar knows four axes. ``RX``, ``RY``, ``J5`` and ``J6`` are assumed here for arms with
six; the installation sheet of the job has it verified on site.
"""

import re
from dataclasses import dataclass

_TOKEN = re.compile(
    r"""\s*(?:
    (?P<text>"[^"]*")
  | (?P<scalar>PR?\[(?:\d+|I\[\d+\])\]\.(?:X|Y|Z|RX|RY|RZ|J[1-6])\b)
  | (?P<variable>[A-Z]+\[(?:\d+|I\[\d+\])\])
  | (?P<address>\d+\.\d+\.\d+\.\d+)
  | (?P<number>\d+\.\d+|0|[1-9]\d*)
  | (?P<word>[A-Za-z_][A-Za-z0-9_]*)
  | (?P<sign>==|!=|>=|<=|[=+\-*/&|<>:])
    )""",
    re.VERBOSE,
)
_KINDS = {
    "I": "I",
    **dict.fromkeys(("H", "B"), "H"),
    "R": "R",
    "S": "S",
    **dict.fromkeys(("P", "PR"), "P"),
    **dict.fromkeys(("DI", "DO", "GIB", "GIH", "GII", "GIF", "GOB", "GOH", "GOI", "GOF"), "D"),
}


class JobError(Exception):
    """A job file that the language does not allow, or a statement that ends in an alarm."""


@dataclass(frozen=True, slots=True)
class Token:
    """``kind`` is one letter: I, H (shorter whole number), R (float), S, P, C (coordinate of a
    position), J (joint of a position), D (digital), T (text), N (number), A (address), W (word or
    sign). The grammar allows coordinates where it does not allow joints."""

    kind: str
    text: str


def tokens(line: str) -> list[Token]:
    """The tokens of one line; none for a comment or note. A minus before a number belongs to it
    where no value stands before it."""
    if line.startswith(("// ", "! ")) or not line.strip():
        return []
    found: list[Token] = []
    place = 0
    while line[place:].strip():
        match = _TOKEN.match(line, place)
        if match is None:
            raise JobError(f"cannot read {line[place:]!r}")
        place = match.end()
        found.append(_token(match))
        if len(found) > 1 and found[-1].kind == "N" and _is_sign_of_number(found):
            found[-2:] = [Token("N", "-" + found[-1].text)]
    return found


def _token(match: re.Match[str]) -> Token:
    kind, text = match.lastgroup, match.group(match.lastgroup or 0)
    if kind == "text":
        return Token("T", text[1:-1])
    if kind == "scalar":
        return Token("J" if text.rpartition(".")[2].startswith("J") else "C", text)
    if kind == "variable":
        family = text.partition("[")[0]
        if family not in _KINDS:
            raise JobError(f"no variable of this language: {text}")
        return Token(_KINDS[family], text)
    return Token({"address": "A", "number": "N"}.get(kind or "", "W"), text)


def _is_sign_of_number(found: list[Token]) -> bool:
    if found[-2] != Token("W", "-"):
        return False
    return len(found) == 2 or found[-3].kind == "W"
