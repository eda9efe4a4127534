"""The seam of the demonstration: what differs from one process to another."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

from fakes.demo.control import Control

Message = Mapping[str, Any]
"""What the line PLC prints: its reading of the cell's registers."""


@dataclass(frozen=True, slots=True)
class Procedure:
    """A procedure of Maintenance, and what the operator prepares for it."""

    number: int
    title: str
    prepare: Callable[[Control, Path], None]
    """Given the control port and the cell file, whose poses the operator knows."""
    timeout_s: float = 300.0
    """How long the line waits for it."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """What is known of a run when it is over."""

    result: Message
    """The last message of the line PLC."""
    truth: Mapping[str, Any]
    """What the fake world says about itself at the end."""
    record: Mapping[str, Any]
    """The cell's own record, as exported; empty when no run was opened."""
    recipe: Mapping[str, Any] = field(default_factory=dict)
    """The recipe of the run, likewise."""

    @property
    def good(self) -> bool:
        """What the cell told the line."""
        return bool(self.result.get("result") == "good")


@dataclass(frozen=True, slots=True)
class Row:
    """A line of the table at the end."""

    name: str
    value: object
    """None for what was not measured."""
    form: str = "{}"
    limit: str = ""
    within: bool | None = None
    """None where there is no limit."""


@dataclass(frozen=True, slots=True)
class Judgement:
    """The cell's result beside the truth."""

    passed: bool
    """The cell says good, and the truth agrees."""
    figures: Mapping[str, Any] = field(default_factory=dict)
    """What ``result.json`` gets, as JSON values."""
    rows: Sequence[Row] = ()


class Demo(ABC):
    """One process on its fake cell."""

    process: ClassVar[str]
    """Its name in the entry point and in the cell file."""
    title: ClassVar[str]
    """What is demonstrated, for the first line in the terminal."""
    cell: ClassVar[Path]
    """The daemon's cell file."""
    scenario: ClassVar[Path]
    """The fake cell's scenario file."""
    cells: ClassVar[Mapping[str, Path]] = {}
    """Shipped cell files by the short names that ``--cell`` takes, too; scenarios lie beside."""
    recipe: ClassVar[int] = 1
    serial: ClassVar[str] = "SAT-{seed:04d}"
    """Serial number of the part."""
    mate_serial: ClassVar[str] = ""
    """Serial number of the part that it is joined to, in the same form."""
    procedures: ClassVar[Sequence[Procedure]] = ()
    """All calibrations of the cell in their order, for ``--calibrate``."""
    steps: ClassVar[Mapping[int, str]] = {}
    """Labels of the steps and procedures by number, which is all that a line PLC reads."""
    telling: ClassVar[Sequence[str]] = ()
    """Keys of a message whose change is worth a line, besides state, step and alarms. ``doing``:
    what the daemon has said last."""

    def prepare(self, control: Control) -> None:  # noqa: B027  most cells begin as they are
        """What the operator does at the cell before the line starts the run."""

    def measure(self, evidence: Evidence) -> Sequence[Sequence[str]]:  # noqa: ARG002
        """Arguments of ``cellctl runs``: what the measuring room enters into the record."""
        return ()

    @abstractmethod
    def judge(self, evidence: Evidence) -> Judgement:
        """Hold what the cell says against the truth."""

    def news(self, before: Message, now: Message) -> str | None:  # noqa: ARG002
        """Words for an event of the live view; None for state and step alone."""
        return None

    def rows(self, now: Message) -> Mapping[str, str]:  # noqa: ARG002
        """Further rows of the live view, by their names."""
        return {}
