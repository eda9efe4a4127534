"""The inner steps of Execute: a typed chain, each with its safe point before it.

What a step returns is what the next one takes, so nothing that a step needs can be missing: the
type checker follows the chain from the first step to the last.
"""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from cellctl import log
from cellctl.runtime.progress import ProgressBoard

if TYPE_CHECKING:
    # Whoever only reads a cell file loads this module too, and must not wait for the database.
    from cellctl.records.run_recorder import RunRecorder

_log = log.get(__name__)

A = TypeVar("A")
B = TypeVar("B")
C = TypeVar("C")


class SafePoint(Protocol):
    """Where a run may pause."""

    async def __call__(self, *, hold: bool = False) -> bool:
        """Obey a pending Hold; with ``hold`` ask for one first.

        True when the cell was held in between: nobody knows what has moved meanwhile, so whatever
        was measured before counts no longer.
        """
        ...


class HeldMeanwhile(Exception):
    """Raised inside a job when a Hold has made its measurements worthless; no job lets it out."""


class Restart(Enum):
    """Whether the steps may begin again once this one is due."""

    FROM_BEGINNING = "from the beginning"
    """A Hold before the step is obeyed, and everything is measured anew after it."""
    NO_WAY_BACK = "no way back"
    """What the step before has done cannot be repeated: a Hold waits until the run has ended."""


@dataclass(frozen=True, slots=True)
class StepSpec(Generic[A, B]):
    """One step of a run: a function from one state to the next, with what line and Hold need."""

    number: int
    """Number of the step, as the line sees it in its step register."""
    label: str
    """Words for logs, reports and terminals."""
    run: Callable[[A], Awaitable[B]]
    contact: bool = False
    """Touches the part: a dry run ends before it, and it deals with trips of the guard itself."""
    restart: Restart = Restart.FROM_BEGINNING
    safe_points_within: bool = False
    """Obeys a Hold itself, between measurements or moves of its own."""


@dataclass(frozen=True, slots=True)
class Steps(Generic[A, B]):
    """A chain that takes ``A`` and gives ``B``."""

    specs: tuple[StepSpec[Any, Any], ...]

    @classmethod
    def first(cls, step: StepSpec[A, B]) -> "Steps[A, B]":
        """A chain of one step."""
        return cls((step,))

    def then(self, step: StepSpec[B, C]) -> "Steps[A, C]":
        """The chain with one more step, which takes what the last one gives."""
        return Steps((*self.specs, step))

    def safe_point_after(self, index: int) -> bool:
        """Whether a Hold that comes in this step is obeyed before a later one."""
        return any(step.restart is not Restart.NO_WAY_BACK for step in self.specs[index + 1 :])

    def before_contact(self) -> "Steps[A, Any]":
        """The steps up to the first one with contact."""
        numbers = [index for index, step in enumerate(self.specs) if step.contact]
        return Steps(self.specs[: numbers[0]] if numbers else self.specs)


@dataclass(slots=True)
class StepRunner:
    """Runs the steps, perhaps several times: what a Hold interrupts begins again."""

    board: ProgressBoard
    safe_point: SafePoint
    recorder: "RunRecorder"
    """Told of every step as a phase of the run."""
    single_step: bool = False
    """Hold before each step that was not reached before; with every Unhold the run measures anew
    and gets one step further."""
    _held_before: set[int] = field(default_factory=set)

    async def run(self, steps: Steps[A, B], state: A) -> B:
        """All steps from the first one; raises ``HeldMeanwhile`` when they must begin again."""
        value: Any = state
        for index, step in enumerate(steps.specs):
            # Before the step and not within it: between two steps nothing moves, so the robots
            # stand wherever the Hold finds them.
            if step.restart is not Restart.NO_WAY_BACK:
                await obey_hold(self.safe_point, hold=self._wants_hold(step))
            self.board.update(
                step=step.number,
                step_label=step.label,
                contact=step.contact,
                safe_point_ahead=step.safe_points_within or steps.safe_point_after(index),
                iteration=0,
                message="",
            )
            # On the disk before the step moves anything: after a crash the record names the step in
            # which it happened.
            await self.recorder.phase(step.number, step.label)
            _log.info("step begins")
            value = await step.run(value)
        result: B = value
        return result

    def _wants_hold(self, step: StepSpec[Any, Any]) -> bool:
        new = self.single_step and step.number not in self._held_before
        self._held_before.add(step.number)
        return new


async def obey_hold(safe_point: SafePoint, *, hold: bool = False) -> None:
    """Pause if that is asked for; raises ``HeldMeanwhile`` when the cell was held in between."""
    if await safe_point(hold=hold):
        raise HeldMeanwhile
