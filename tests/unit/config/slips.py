"""Single edits of the figures of a cell file: what a slip of the keyboard makes of each."""

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

_KEY = re.compile(r"([A-Za-z_]\w*)\s*=")
_TABLE = re.compile(r"^\[+([\w.\-]+)\]+")
_FIGURE = re.compile(r"(?<![\w.\"'])-?\d+(?:\.\d+)?(?![\w.\"'])")
_STRING = re.compile(r'"[^"]*"')

SLIPS = ("x10", "/10", "sign", "+10", "-10")


@dataclass(frozen=True, slots=True)
class Figure:
    """One number of a cell file."""

    key: str
    """Its table and name; with the place within brackets where the value is a list."""
    start: int
    end: int
    text: str
    listed: bool
    """Whether it is part of a list, as the figures of poses are."""


@dataclass(frozen=True, slots=True)
class Edit:
    """One figure of a cell file, written otherwise."""

    figure: Figure
    slip: str
    after: str

    @property
    def name(self) -> str:
        """Key and slip, as the list of what passes has it."""
        return f"{self.figure.key} {self.slip}"

    def of(self, text: str) -> str:
        """The cell file with this edit."""
        return text[: self.figure.start] + self.after + text[self.figure.end :]


def figures(text: str) -> Iterator[Figure]:
    """Every number of a cell file, in its order."""
    table, start = "", 0
    for line in text.splitlines(keepends=True):
        # Texts and comments keep their length, so that places in the line stay what they are.
        plain = _STRING.sub(lambda found: '"' * len(found[0]), line)
        plain = plain.split("#", 1)[0]
        if header := _TABLE.match(plain):
            table = header[1]
        else:
            yield from _of_line(plain, table, start)
        start += len(line)


def _of_line(plain: str, table: str, start: int) -> Iterator[Figure]:
    keys = list(_KEY.finditer(plain))
    times: Counter[str] = Counter()
    for found in _FIGURE.finditer(plain):
        named = [key for key in keys if key.end() <= found.start()]
        if not named:
            continue
        before = plain[named[-1].end() : found.start()]
        listed = before.lstrip().startswith("[")
        # An inline table names its figures by both keys.
        inline = named[0][1] != named[-1][1] and "{" in plain[: found.start()]
        names = [named[0][1], named[-1][1]] if inline else [named[-1][1]]
        path = ".".join([table, *names]) if table else ".".join(names)
        key = f"{path}[{times[path]}]" if listed else path
        times[path] += 1
        yield Figure(key, start + found.start(), start + found.end(), found[0], listed)


def edits(text: str) -> Iterator[Edit]:
    """Every slip of every figure that makes another value of it; whole numbers stay whole."""
    for figure in figures(text):
        seen = {float(figure.text)}
        for slip in SLIPS:
            after = _slipped(figure.text, slip)
            if float(after) not in seen:
                seen.add(float(after))
                yield Edit(figure, slip, after)


def _slipped(text: str, slip: str) -> str:
    whole = "." not in text
    value = float(text)
    other = {
        "x10": value * 10.0,
        "/10": value / 10.0,
        "sign": -value,
        "+10": value + 10.0,
        "-10": value - 10.0,
    }[slip]
    return str(int(other)) if whole else repr(round(other, 9))
