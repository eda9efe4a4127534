"""A procedure of Maintenance: its number, what it is given, and what it gives back."""

from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass
from datetime import timedelta
from typing import TYPE_CHECKING, Any

from cellctl.calibration.store.kind import CalibrationKind
from cellctl.runtime.guide import UNGUIDED, Guide
from cellctl.runtime.progress import ProgressBoard
from cellctl.runtime.steps import HeldMeanwhile, SafePoint

if TYPE_CHECKING:
    # Whoever only reads a cell file loads this module too, and must not wait for the database.
    from cellctl.runtime.jobs.record import JobRecord


@dataclass(frozen=True, slots=True)
class ProcedureContext:
    """The place to tell of progress, and the record of a procedure that needs one."""

    board: ProgressBoard
    safe_point: SafePoint
    record: "JobRecord"
    """The record of the run. A procedure that ``opens_record`` opens it before it moves
    anything."""

    async def progress(self, done: int, total: int, message: str) -> None:
        """Tell how far it is, and obey a pending Hold.

        Raises ``HeldMeanwhile`` when the cell was held: boards, heads and payload may have been
        touched, so the procedure begins again.
        """
        self.board.update(iteration=done, message=f"{message} {done} of {total}")
        if await self.safe_point():
            raise HeldMeanwhile


@dataclass(frozen=True, slots=True)
class ProcedureOutcome:
    """A result on its way to the store."""

    kind: CalibrationKind[Any]
    """What was calibrated."""
    record: Mapping[str, Any]
    passed: bool
    warnings: tuple[str, ...]
    picture_png: bytes | None
    serial_number: str
    """Serial number of the instrument that was calibrated."""
    bounds: frozenset[str] = frozenset()
    """Names of the checks of its record that hold it against an upper bound of recipe or settings.
    Where these alone fail, the measurement is good and the bound is not: production then starts
    neither with the bound nor with what was stored before."""


@dataclass(frozen=True, slots=True)
class Procedure:
    """One procedure, bound to its cell by the process that offers it."""

    number: int
    """As the line gives it in its recipe register; from 100 on."""
    step: int
    """As the line sees it in its step register."""
    label: str
    run: Callable[[ProcedureContext], Awaitable[ProcedureOutcome | None]]
    """Its result is None when the procedure waits for its counterpart, such as 104 for 105, or only
    checks something."""
    valid_for: timedelta
    """How long a result that passes stays valid."""
    contact: bool = False
    """Touches the part, so that it deals with trips of the guard itself."""
    guide: Guide = UNGUIDED
    """What the person has to know who runs it."""
    handles_parts: bool = False
    """Works on the parts of a recipe without touching one against the other."""

    @property
    def opens_record(self) -> bool:
        """Whether it opens the record of its run itself, with the recipe whose parts it works on
        and the calibrations that count. For any other procedure the record is opened before it
        begins, without either."""
        return self.contact or self.handles_parts
