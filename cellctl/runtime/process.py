"""The interface of a process: everything in which one process differs from another.

A process is a class behind the entry point ``cellctl.process``. Its static half
(``ProcessDefinition``) tells the cell file's models, roles and checks; the daemon makes one object
of it for its cell, and calls the methods below. The rest of cellctl knows no process.
"""

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from cellctl.calibration.store.envelope import StoredCalibration
from cellctl.calibration.store.kind import CalibrationKind, Kinds
from cellctl.calibration.store.store import CalibrationStore
from cellctl.cell.devices import Cell
from cellctl.config.cell import CellConfig
from cellctl.config.process_definition import ProcessDefinition, process_definition
from cellctl.config.recipe import Recipe
from cellctl.errors import CellError
from cellctl.errors.config import UnknownDriver
from cellctl.errors.records.store import NotReplayable
from cellctl.records.entries import Calibration, RunRecord
from cellctl.records.replay.replayed import Replayed
from cellctl.records.report.sections import ProcessPages, ReadArtefact
from cellctl.records.required.required_figures import RequiredFigure
from cellctl.runtime.interruption import Interruption
from cellctl.runtime.procedure import Procedure, ProcedureReplay
from cellctl.runtime.progress import ProgressBoard
from cellctl.runtime.steps import SafePoint, Steps

if TYPE_CHECKING:
    # Whoever only reads a cell file loads this module too, and must not wait for the database.
    from cellctl.records.async_store import AsyncRunStore
    from cellctl.records.run_recorder import RunRecorder

P = TypeVar("P")
R = TypeVar("R")
S = TypeVar("S")


@dataclass(frozen=True, slots=True)
class CellServices:
    """What the daemon lends to every process of its cell."""

    cell: Cell
    calibrations: CalibrationStore
    board: ProgressBoard
    store: "AsyncRunStore"


@dataclass(frozen=True, slots=True)
class Prepared(Generic[P]):
    """A run for which everything was read and checked; nothing has moved yet."""

    facts: P
    """Whatever the process needs for the run."""
    stored: tuple[StoredCalibration, ...]
    """Calibrations that count in the run, for its record."""


@dataclass(frozen=True, slots=True)
class RunContext:
    """What a process is given for one open run."""

    recorder: "RunRecorder"
    """Writes into the record of this run."""
    safe_point: SafePoint
    """Obeys a pending Hold; a step that waits long or repeats itself calls it in between."""
    interruption: Interruption = field(default_factory=Interruption)
    """Ends a step in contact that runs inside it, for a process that then backs off."""


class Process(ProcessDefinition, Generic[P, R, S]):
    """One process in one cell.

    ``P`` is what is known before a run, ``R`` an open run, ``S`` what the first step takes.
    """

    no_replay: ClassVar[str] = "cannot be computed anew: its process does not know how"
    """Why ``replay`` is refused, for a process that has none: words after "run N of NAME"."""

    spoiled_by: ClassVar[frozenset[type[CellError]]] = frozenset()
    """Faults that say that the part is bad, where the run itself went as it should."""

    def __init__(self, services: CellServices) -> None:
        self.services = services

    @classmethod
    def calibration_kinds(cls) -> Kinds:
        """The calibrations that it requires, or uses when they are there.

        A method, because the parsers of kinds load what computes, and whoever only reads a cell
        file loads this class too.
        """
        return ()

    @abstractmethod
    async def prepare(self, recipe: Recipe) -> Prepared[P]:
        """Starting, before anything moves: read and check everything that a run needs.

        Asked again after a Hold, whose run goes on with what was read first, and only with the same
        calibrations. Raises the fault that keeps the run from beginning.
        """

    @abstractmethod
    def open(self, prepared: Prepared[P], context: RunContext) -> R:
        """The run, once its record is open: what lasts over all beginnings of its steps."""

    def required(self, run: R) -> Sequence[RequiredFigure]:  # noqa: ARG002
        """The figures without which no part of this run is good, with the limits of its recipe.

        The record keeps them before anything moves. One that was not measured is told as such in
        everything that shows the run, and a run that ends without one is not good. By default none.
        """
        return ()

    @abstractmethod
    async def begin(self, run: R) -> S:
        """Bring the cell to where the steps begin; what the first one takes.

        Called at the end of Starting, and again whenever the steps begin anew after a Hold.
        """

    @abstractmethod
    def steps(self, recipe: Recipe) -> Steps[S, Any]:
        """The steps of Execute in their order."""

    @abstractmethod
    async def clear(self) -> None:
        """Reset, with all robots ready: leave the station, whatever a run has left there."""

    async def show_contact_force(self) -> None:
        """Have the guards show the force on the part, as far as it is known; moves nothing.

        Without the weight of the payload, and in the frame of the part as in a run: the sensor's
        own z may look the other way. Called once after a start that found an interrupted run, or an
        arm in the place of a part, so that the operator is told the force of the contact and not
        the weight of the part. Raises the faults of calibrations, robot and guard; by default
        nothing is done.
        """

    @classmethod
    def report(cls, record: RunRecord, read: ReadArtefact) -> ProcessPages:  # noqa: ARG003
        """What the report of a run shows besides the pages that any run has; by default nothing.

        Called without a cell, also for runs that ended early and for those of earlier versions.
        ``read`` gives the bytes of a file of the run and raises ``ArtefactDamaged``.
        """
        return ProcessPages()

    @classmethod
    def replay(
        cls,
        record: RunRecord,
        read: ReadArtefact,  # noqa: ARG003
        calibrations: Mapping[str, Calibration],  # noqa: ARG003
    ) -> Iterator[Replayed]:
        """Compute every measurement of a recorded run anew, beside what the record says.

        Called without a cell, like ``report``; ``calibrations`` of the store by their ids. Raises
        ``NotReplayable``.
        """
        raise NotReplayable(f"run {record.head.number} of {record.head.process} {cls.no_replay}")

    def procedures(self) -> Sequence[Procedure]:
        """Calibrations and other measurements of Maintenance, by their numbers."""
        return ()

    @classmethod
    def procedure_replays(cls) -> Mapping[int, ProcedureReplay]:
        """How the recorded run of a procedure is computed anew, by the number of the procedure.

        Called without a cell. One that opens its own record is no procedure here: its run is one
        of the process, and ``replay`` gets it.
        """
        return {}


def open_processes(services: CellServices) -> dict[str, Process[Any, Any, Any]]:
    """Every process that the cell file names, by name; raises ``UnknownDriver``."""
    processes: dict[str, Process[Any, Any, Any]] = {}
    for name in services.cell.config.processes:
        processes[name] = _process_class(name)(services)
    return processes


def calibration_kinds(config: CellConfig) -> list[CalibrationKind[Any]]:
    """Kinds of every process that the cell file names; raises ``UnknownDriver``."""
    return [kind for name in config.processes for kind in _process_class(name).calibration_kinds()]


def _process_class(name: str) -> type[Process[Any, Any, Any]]:
    definition = process_definition(name)
    # A definition alone is enough for ``cellctl check``; only the daemon needs something that can
    # run.
    if not issubclass(definition, Process):
        raise UnknownDriver(f"process '{name}' has checks but cannot run")
    return definition
