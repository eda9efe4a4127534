"""A job file as a list of statements with jumps: the grammar, after the facts of its lexer."""

from dataclasses import dataclass
from pathlib import Path

from fakes.robot_jobs.lexer import JobError, Token, tokens

_VARIABLES = "IHR"
_OPERANDS = "NIHRC"
"""Operands of an expression: the grammar allows the coordinates of a position, not its joints."""
_VALUES = "NIHRCJ"
"""Values that SET, a condition, ABS and SQRT take."""
_MOTION = ("P 'V '= N|I|H|R 'ACC '= N 'FINE", "P 'V '= N|I|H|R 'ACC '= N 'FINE ': 'SKIP T")
FORMS: dict[str, tuple[str, ...]] = {
    "SET": ("P P", "I|H|R|C|J N|I|H|R|C|J", "S S|T"),
    "GETP": ("P",),
    "SETP": ("P 'FRAME 'TF N|I|H", "P 'FRAME 'UF N|I|H"),
    "SETFRAME": ("'TF N|I|H", "'UF N|I|H"),
    "STRLEN": ("S I",),
    "STRFIND": ("S S I",),
    "STRFINDEND": ("S S I",),
    "STRSUB": ("S I I S",),
    "STRCMP": ("S S I",),
    "STR2I": ("S I",),
    "STR2R": ("S R",),
    "I2STR": ("I S",),
    "IN": ("I|R '= D",),
    "OUT": ("D N|I|H|R",),
    "DELAY": ("'T '= N|I|H|R",),
    "WAIT": ("D '= N|I|H 'T '= N|I|H",),
    "LABEL": ("T",),
    "GOTO": ("T",),
    "START_BG": ("W",),
    "STOP_BG": ("W",),
    "UALM": ("'CODE '= N|I|H",),
    "PAUSE": ("",),
    "TIMER": ("'START 'INDEX '= N", "'STOP 'INDEX '= N I|R"),
    "SKIP": ("'CONDITION D '== N",),
    "MOVJ": _MOTION,
    "MOVL": _MOTION,
    "TCPCREATE": ("T 'SERVERIP '= A 'PORT '= N|I",),
    "TCPSEND": ("T S|N",),
    "TCPRECV": ("T S N|I|H 'TIMEOUT '= N|I|H I",),
    "TCPCLOSE": ("T",),
}
"""Word by word, what may follow it: kinds of tokens, and words of the language after a quote."""
_AFTER_IF = {"GOTO", "OUT", "DELAY", "WAIT"}
_FUNCTIONS = {"ABS": _VARIABLES, "SQRT": "R"}
"""Kinds of the variable that may take the result, by the word of the function."""
_RELATIONS = {"==", "!=", ">", ">=", "<", "<="}


@dataclass(frozen=True, slots=True)
class Condition:
    """Comparisons that all hold, or of which one holds: left, relation, right."""

    every: bool
    parts: tuple[tuple[Token, str, Token], ...]


@dataclass(frozen=True, slots=True)
class Statement:
    """One line that is executed. ``jump`` is where a false condition, or a jump, goes on."""

    line: int
    word: str
    tokens: tuple[Token, ...] = ()
    condition: Condition | None = None
    then: "Statement | None" = None
    jump: int = -1


@dataclass(frozen=True, slots=True)
class Program:
    """The statements of a job and the places of its labels."""

    name: str
    statements: tuple[Statement, ...]
    labels: dict[str, int]


def load_program(path: Path) -> Program:
    """Read a job file; raises ``JobError`` with the line that the language does not allow."""
    return read_program(path.stem, path.read_text("ascii"))


def read_program(name: str, text: str) -> Program:
    """The same for the text of a job."""
    lines = text.splitlines()
    if not lines or lines[0] != "NOP" or lines[-1] != "END":
        raise JobError(f"{name}: a job begins with NOP and ends with END")
    return _Reader(name).program(lines[1:-1])


class _Reader:
    def __init__(self, name: str) -> None:
        self._name = name
        self._statements: list[Statement] = []
        self._labels: dict[str, int] = {}
        self._open: list[int] = []
        """Places of the IF and ELSE whose ENDIF has not come."""

    def program(self, lines: list[str]) -> Program:
        for number, line in enumerate(lines, 2):
            try:
                if found := tokens(line):
                    self._take(number, found)
            except JobError as error:
                raise JobError(f"{self._name}, line {number}: {error}") from None
        if self._open:
            raise JobError(f"{self._name}: IF without ENDIF")
        self._check_labels()
        return Program(self._name, tuple(self._statements), self._labels)

    def _take(self, number: int, found: list[Token]) -> None:
        word = found[0].text
        if word == "IF":
            self._take_if(number, found)
        elif word == "ELSE":
            self._close(len(self._statements) + 1)
            self._open.append(len(self._statements))
            self._statements.append(Statement(number, "JUMP"))
        elif word == "ENDIF":
            self._close(len(self._statements))
        else:
            statement = _plain(number, found)
            if word == "LABEL":
                self._label(found[1].text)
            self._statements.append(statement)

    def _label(self, name: str) -> None:
        if name in self._labels:
            raise JobError(f"label {name} twice")
        self._labels[name] = len(self._statements)

    def _take_if(self, number: int, found: list[Token]) -> None:
        colon = Token("W", ":")
        end = found.index(colon) if colon in found else len(found)
        condition = _condition(found[1:end])
        if end == len(found):
            self._open.append(len(self._statements))
            self._statements.append(Statement(number, "IF", condition=condition))
            return
        then = _plain(number, found[end + 1 :])
        if then.word not in _AFTER_IF:
            raise JobError(f"{then.word} cannot follow IF in one line")
        self._statements.append(Statement(number, "IF", condition=condition, then=then))

    def _close(self, place: int) -> None:
        if not self._open:
            raise JobError("ELSE or ENDIF without IF")
        opened = self._open.pop()
        old = self._statements[opened]
        self._statements[opened] = Statement(
            old.line, old.word, condition=old.condition, jump=place
        )

    def _check_labels(self) -> None:
        for statement in self._statements:
            one = statement.then or statement
            jumps = one.word in {"GOTO", "MOVJ", "MOVL"} and one.tokens[-1].kind == "T"
            if jumps and one.tokens[-1].text not in self._labels:
                raise JobError(f"{self._name}, line {one.line}: no label {one.tokens[-1].text}")


def _plain(number: int, found: list[Token]) -> Statement:
    word, rest = found[0], found[1:]
    if word.kind != "W":
        return Statement(number, "=", _assignment(found))
    forms = FORMS.get(word.text)
    if forms is None:
        raise JobError(f"no word of this language: {word.text}")
    if not any(_fits(form.split(), rest) for form in forms):
        raise JobError(f"{word.text} does not allow {[token.text for token in rest]}")
    return Statement(number, word.text, tuple(rest))


def _fits(form: list[str], found: list[Token]) -> bool:
    if len(form) != len(found):
        return False
    return all(
        token.text == item[1:] if item.startswith("'") else token.kind in item.split("|")
        for item, token in zip(form, found, strict=True)
    )


def _assignment(found: list[Token]) -> tuple[Token, ...]:
    """``number = value``, ``= ABS value``, ``= SQRT value``, a chain of values with one operator,
    or a chain of strings with ``+``.

    No public text says which operator binds stronger, so a chain of two kinds is refused.
    """
    if len(found) < 3 or found[1].text != "=":
        raise JobError(f"not a statement: {[token.text for token in found]}")
    target, values = found[0], found[2:]
    if target.kind not in (*_VARIABLES, "C", "S"):
        raise JobError(f"nothing can be assigned to {target.text}")
    if values[0].text in _FUNCTIONS:
        _check_function(target, values)
        return tuple(found)
    allowed = "S" if target.kind == "S" else _OPERANDS
    operators = {token.text for token in values[1::2]}
    correct = len(values) % 2 and all(token.kind in allowed for token in values[::2])
    if not correct or len(operators) > 1 or not operators <= set("+-*/&"):
        raise JobError(f"not an expression: {[token.text for token in values]}")
    if target.kind == "S" and not operators <= {"+"}:
        raise JobError("strings can only be added")
    return tuple(found)


def _check_function(target: Token, values: list[Token]) -> None:
    word = values[0].text
    if target.kind not in _FUNCTIONS[word]:
        raise JobError(f"{word} has no result for {target.text}")
    if len(values) != 2 or values[1].kind not in _VALUES:
        raise JobError(f"{word} takes one value")


def _condition(found: list[Token]) -> Condition:
    words = {token.text for token in found[3::4]}
    parts = [found[place : place + 3] for place in range(0, len(found), 4)]
    if len(words) > 1 or not words <= {"AND", "OR"} or any(len(part) != 3 for part in parts):
        raise JobError("not a condition")
    for left, relation, right in parts:
        known = left.kind in (*_VALUES, "D") and right.kind in _VALUES
        if not known or relation.text not in _RELATIONS:
            raise JobError(f"cannot compare {left.text} {relation.text} {right.text}")
    return Condition(words != {"OR"}, tuple((part[0], part[1].text, part[2]) for part in parts))
