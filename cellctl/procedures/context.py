"""What every calibration procedure is given, and what it gives back."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from cellctl.cell.devices import Cell
from cellctl.processes.deck_to_frame.recipe import Recipe
from cellctl.runtime.calibration_folder import CalibrationFolder
from cellctl.runtime.job import HeldMeanwhile, SafePoint
from cellctl.runtime.job_record import JobRecord
from cellctl.runtime.progress import ProgressBoard


@dataclass(frozen=True, slots=True)
class ProcedureContext:
    """Devices, earlier calibrations and the place to tell of progress."""

    cell: Cell
    calibrations: CalibrationFolder
    board: ProgressBoard
    safe_point: SafePoint
    record: JobRecord
    """To be opened by a procedure with contact, before it moves."""
    recipe: Recipe
    """Whose parts are there, for procedures that touch them."""

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

    item: str
    """Name of the calibration item, for example ``head_1``."""
    record: Mapping[str, Any]
    passed: bool
    warnings: tuple[str, ...]
    picture_png: bytes | None
    serial_number: str
    """Of the instrument that was calibrated."""
