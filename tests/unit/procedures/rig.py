"""A procedure's surroundings: cell in memory, archive, and a safe point that a test controls."""

from pathlib import Path
from typing import Any

from cellctl.processes.deck_to_frame.process import DeckToFrame
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.store import RunStore
from cellctl.runtime.jobs.factory import procedures_by_number
from cellctl.runtime.jobs.maintenance import MaintenanceJob
from cellctl.runtime.jobs.record import JobRecord
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome
from cellctl.runtime.process import CellServices
from cellctl.runtime.progress import Progress, ProgressBoard
from tests.unit.cell.bench import Bench, start_command
from tests.unit.processes.deck_to_frame.rig import Pauses


class ProcedureRig:
    """Everything a procedure is given."""

    def __init__(self, bench: Bench, store: Path) -> None:
        self.bench = bench
        self.archive = AsyncRunStore(store)
        self.board = ProgressBoard()
        self.pauses = Pauses()
        self.told: list[Progress] = []
        self.board.observers.append(self.told.append)
        self.renew()

    def renew(self) -> None:
        """Procedures with the devices that are there now."""
        self.process = DeckToFrame(self.services)
        self.procedures = procedures_by_number({"deck-to-frame": self.process})

    @property
    def context(self) -> ProcedureContext:
        record = JobRecord(self.bench.as_cell, self.archive, start_command(unit_mode=2))
        return ProcedureContext(self.board, self.pauses, record)

    @property
    def services(self) -> CellServices:
        bench = self.bench
        return CellServices(bench.as_cell, bench.calibrations, self.board, self.archive)

    async def run(self, number: int) -> ProcedureOutcome:
        """A procedure of the process, as the line would start it; it must have a result."""
        outcome = await self.procedures[number].run(self.context)
        assert outcome is not None
        return outcome

    def answer(self, **answers: Any) -> None:
        """What the workers return instead of working."""
        for name, value in answers.items():
            self.bench.cell.workers.answers[name] = value

    def job(self, number: int) -> MaintenanceJob:
        command = start_command(unit_mode=2, recipe_id=number, order="OP-3")
        return MaintenanceJob(self.services, self.procedures[number], command, self.pauses)

    async def audit(self) -> list[tuple[str, str, dict[str, Any]]]:
        def read(store: RunStore) -> list[tuple[str, str, dict[str, Any]]]:
            return [(entry.actor, entry.action, dict(entry.detail)) for entry in store.audit_log()]

        return await self.archive.do(read)
