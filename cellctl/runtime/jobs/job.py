"""One run of the cell, from Starting to Completing: a part that is made, or a procedure."""

from abc import ABC, abstractmethod

from cellctl.config.recipe import LineLostAction
from cellctl.errors import CellError
from cellctl.records.entries import RunResult


class Job(ABC):
    """Called by the unit only, in this order, in the states named. ``close`` always comes last.

    ``interrupt`` may be called at any time in Execute.
    """

    number: int
    """Number of the recipe or procedure, as the line knows it."""
    serial: str
    makes_part: bool = False
    """True for a job whose good end counts as one more part."""
    line_lost_in_contact: LineLostAction = LineLostAction.KEEP

    @property
    def run_number(self) -> int:
        """Number of the run in its record; 0 while there is none."""
        return 0

    @property
    def outcome(self) -> RunResult:
        """Result of a run that came to its end without a fault."""
        return RunResult.GOOD

    def interrupt(self, fault: CellError) -> bool:  # noqa: ARG002 - for jobs that can be
        """Have a step in contact end by this fault in its own way; False when none can."""
        return False

    @abstractmethod
    async def start(self) -> None:
        """Starting: open the run record, then bring robots to where the run begins."""

    @abstractmethod
    async def execute(self) -> None:
        """Execute: do the work; a fault leaves as an exception."""

    @abstractmethod
    async def close(self, outcome: RunResult, fault: CellError | None) -> RunResult:
        """Completing, Stopping or Aborting: close the run record; the outcome that it states."""
