"""A procedure of Maintenance: its number, what it is given, and what it gives back."""

from collections import Counter
from collections.abc import Awaitable, Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import timedelta
from typing import TYPE_CHECKING, Any

from cellctl.calibration.store.kind import CalibrationKind
from cellctl.clock import utc_at
from cellctl.interfaces.exposure import ExposureRecord
from cellctl.interfaces.stereo_camera import Image, StereoPair
from cellctl.records.looks import TakenImage, documents_of_look
from cellctl.records.replay.recorded_run import PROCEDURE_INPUT, RecordedRun
from cellctl.records.replay.replayed import Replayed
from cellctl.runtime.guide import UNGUIDED, Guide
from cellctl.runtime.progress import ProgressBoard
from cellctl.runtime.steps import HeldMeanwhile, SafePoint

if TYPE_CHECKING:
    # Whoever only reads a cell file loads this module too, and must not wait for the database.
    from cellctl.records.run_recorder import RunRecorder
    from cellctl.runtime.jobs.record import JobRecord

ProcedureReplay = Callable[[RecordedRun], Iterator[Replayed]]
"""Computes the recorded run of one procedure anew; raises ``NotReplayable`` with what its record
lacks."""


@dataclass(frozen=True, slots=True, eq=False)
class TakenView:
    """One image that the result of a procedure is computed from."""

    view: str
    """Name of the camera, of a stereo head with its side: ``head_1-left``."""
    image: Image
    time_s: float
    """Monotonic, when it had been received."""
    exposure: ExposureRecord | None = None


def views_of_pair(head: str, pair: StereoPair) -> tuple[TakenView, TakenView]:
    """The images of a stereo head."""
    left, right = pair.exposures or (None, None)
    return (
        TakenView(f"{head}-left", pair.left, pair.time_s, left),
        TakenView(f"{head}-right", pair.right, pair.time_s, right),
    )


@dataclass(frozen=True, slots=True)
class ProcedureContext:
    """The place to tell of progress, and the record of a procedure that needs one."""

    board: ProgressBoard
    safe_point: SafePoint
    record: "JobRecord"
    """The record of the run. A procedure that ``opens_record`` opens it before it moves
    anything."""
    _looks: Counter[str] = field(default_factory=Counter)

    async def progress(self, done: int, total: int, message: str) -> None:
        """Tell how far it is, and obey a pending Hold.

        Raises ``HeldMeanwhile`` when the cell was held: boards, heads and payload may have been
        touched, so the procedure begins again.
        """
        self.board.update(iteration=done, message=f"{message} {done} of {total}")
        if await self.safe_point():
            raise HeldMeanwhile

    async def keep_input(self, content: Mapping[str, Any]) -> None:
        """Keep what the result is computed from, before it is: for ``cellctl replay``.

        Plain data in SI units with all digits. Kept again, after a Hold, it replaces what was kept
        before. Raises ``RecordNotWritten``.
        """
        if recorder := self.recorder:
            await recorder.document(PROCEDURE_INPUT, content)

    async def keep_images(self, look: str, views: Sequence[TakenView]) -> list[str]:
        """Keep the images of one look as they are; the names of their files.

        Returns before they are on the disk: nothing that moves or measures waits for that. Raises
        ``RecordNotWritten``.
        """
        name = self.new_look(look)
        files = {f"raw/{name}-frame-1-{one.view}.pgm.zst": one for one in views}
        if recorder := self.recorder:
            taken = {
                file: TakenImage(name, one.view, utc_at(one.time_s)) for file, one in files.items()
            }
            await recorder.exposures({file: one.exposure for file, one in files.items()})
            await recorder.add(*documents_of_look(name, taken, {}))
            for file, one in files.items():
                recorder.raw_image(file, one.image)
        return list(files)

    def new_look(self, look: str) -> str:
        """The name of a look for its images, which no other look of the run has."""
        # One that comes again, after a Hold, gets a number: no file hides another.
        self._looks[look] += 1
        again = self._looks[look]
        return look if again == 1 else f"{look}-again-{again}"

    @property
    def recorder(self) -> "RunRecorder | None":
        """Writes into the record of the run, as soon as that is open."""
        # Only here, for the sake of whoever reads a cell file.
        from cellctl.records.run_recorder import RunRecorder

        record = self.record
        return RunRecorder(record.store, record.number) if record.number else None


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
    """Number that the line writes to its recipe register; from 100 on."""
    step: int
    """Number that the line sees in its step register."""
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
