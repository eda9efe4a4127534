"""Variables, positions and digital signals of a controller that runs jobs."""

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field

from fakes.robot_jobs.lexer import JobError, Token
from fakes.robot_jobs.position import Position

STRING_MAX = 128
"""Bytes of a string variable: an assumption, so that no job relies on more."""
_WHOLE = {"I": 2**31, "H": 2**15, "B": 2**8}


@dataclass(slots=True)
class Memory:
    """What all jobs share. ``inputs`` answers for DI and group inputs, by name and index."""

    inputs: Callable[[str, int], int]
    numbers: dict[tuple[str, int], float] = field(default_factory=lambda: defaultdict(float))
    strings: dict[int, str] = field(default_factory=lambda: defaultdict(str))
    positions: dict[int, Position] = field(default_factory=lambda: defaultdict(Position))
    """PR, the global ones."""
    outputs: dict[tuple[str, int], int] = field(default_factory=lambda: defaultdict(int))

    def number(self, token: Token, local: dict[int, Position]) -> float:
        """The value of a number, a variable, a scalar of a position or a digital signal."""
        if token.kind == "N":
            return float(token.text)
        if token.kind in "CJ":
            position, name = self.scalar(token, local)
            return position.read(name)
        family, index = self._place(token.text)
        if token.kind != "D":
            return self.numbers[family, index]
        if family.startswith(("DO", "GO")):
            return self.outputs[family, index]
        return self.inputs(family, index)

    def set_number(self, token: Token, value: float, local: dict[int, Position]) -> None:
        """Assign; whole variables take no fraction and must not overflow."""
        if token.kind in "CJ":
            position, name = self.scalar(token, local)
            position.write(name, value)
            return
        family, index = self._place(token.text)
        if limit := _WHOLE.get(family):
            value = float(int(value))
            if not -limit <= value < limit:
                raise JobError(f"{token.text} cannot hold {value}")
        self.numbers[family, index] = value

    def set_output(self, token: Token, value: float) -> None:
        """OUT; raises ``JobError`` for an input."""
        family, index = self._place(token.text)
        if not family.startswith(("DO", "GO")):
            raise JobError(f"{token.text} is no output")
        self.outputs[family, index] = int(value)

    def string(self, token: Token) -> str:
        """A text or the value of a string variable."""
        return token.text if token.kind == "T" else self.strings[self._place(token.text)[1]]

    def set_string(self, token: Token, value: str) -> None:
        """Assign; a string has a greatest length."""
        if len(value) > STRING_MAX:
            raise JobError(f"{token.text} cannot hold {len(value)} characters")
        self.strings[self._place(token.text)[1]] = value

    def position(self, token: Token, local: dict[int, Position]) -> Position:
        """A position variable, P of the job or PR of the controller."""
        family, index = self._place(token.text)
        return (self.positions if family == "PR" else local).setdefault(index, Position())

    def scalar(self, token: Token, local: dict[int, Position]) -> tuple[Position, str]:
        """The position that a scalar belongs to, and its name there."""
        variable, _, name = token.text.rpartition(".")
        return self.position(Token("P", variable), local), name

    def _place(self, text: str) -> tuple[str, int]:
        family, _, index = text.removesuffix("]").partition("[")
        if index.startswith("I["):
            return family, int(self.numbers["I", int(index.removesuffix("]")[2:])])
        return family, int(index)
