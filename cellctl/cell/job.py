"""One run of the cell, from Starting to Completing: an assembly or a calibration procedure."""

from abc import ABC, abstractmethod
from collections.abc import Awaitable, Callable

from cellctl.errors import CellError
from cellctl.records.entries import RunResult

SafePoint = Callable[[], Awaitable[bool]]
"""Obeys a pending Hold; True when the cell was held in between, so that it must measure again."""


class Job(ABC):
    """Called by the unit only, in this order, in the states named. ``close`` always comes last."""

    number: int
    """Recipe or procedure, for the line."""
    serial: str
    run_number: int = 0

    @abstractmethod
    async def start(self) -> None:
        """Starting: open the run record, then bring robots to where the run begins."""

    @abstractmethod
    async def execute(self, safe_point: SafePoint) -> None:
        """Execute: do the work; a fault leaves as an exception."""

    @abstractmethod
    async def close(self, outcome: RunResult, fault: CellError | None) -> None:
        """Completing, Stopping or Aborting: close the run record."""
