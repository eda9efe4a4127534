"""The root of every fault: a stable number, words for the operator, and what the cell does."""

from enum import Enum
from typing import ClassVar


class Reaction(Enum):
    """What the state machine does when a fault reaches it."""

    WARN = "warn"
    """Record it and go on."""
    HOLD = "hold"
    """Go to Held at the next safe point."""
    STOP = "stop"
    """Controlled stop; the part run ends."""
    ABORT = "abort"
    """Stop all motion now; latch until Clear."""


class CellError(Exception):
    """A fault with a number. Subclasses fill in the catalogue entry; instances add the facts.

    ``str(error)`` reads ``F412 <operator text>: <facts of this occurrence>``. Number and facts are
    all that goes from one process to another, so a subclass has no further arguments.
    """

    number: ClassVar[int] = 0
    text: ClassVar[str] = ""
    """What happened, for the operator. No trailing full stop."""
    cause: ClassVar[str] = ""
    remedy: ClassVar[str] = ""
    reaction: ClassVar[Reaction] = Reaction.ABORT

    def __init__(self, detail: str = "") -> None:
        super().__init__(detail)
        self.detail = detail

    def __str__(self) -> str:
        head = f"F{self.number:03d} {self.text}"
        return f"{head}: {self.detail}" if self.detail else head


def fault_number(written: str | int) -> int:
    """The number of a fault as people write it: ``F529``, ``f529`` or ``529``.

    Raises ``ValueError``.
    """
    digits = str(written).removeprefix("F").removeprefix("f")
    if not digits.isdecimal():
        raise ValueError(f"{written!r} is no number of a fault, such as F529")
    return int(digits)


def catalogue(root: type[CellError] = CellError) -> list[type[CellError]]:
    """Every numbered fault below ``root``, by number, from the modules that are imported.

    ``cellctl.fault_catalogue`` imports those that an installation has.
    """
    found: list[type[CellError]] = []
    pending = [root]
    while pending:
        cls = pending.pop()
        pending.extend(cls.__subclasses__())
        # A driver may have classes of its own below a fault, which then share its number.
        if vars(cls).get("number"):
            found.append(cls)
    return sorted(found, key=lambda cls: cls.number)
