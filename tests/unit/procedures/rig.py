"""A procedure's surroundings: cell in memory, archive, and a safe point that a test controls."""

from pathlib import Path
from typing import Any

from cellctl.procedures.context import ProcedureContext
from cellctl.runtime.procedure_registry import procedure_order
from sqlalchemy import select

from cellctl.records.async_store import AsyncRunStore
from cellctl.records.schema import AuditRow
from cellctl.records.store import RunStore
from cellctl.runtime.job_record import JobRecord
from cellctl.runtime.maintenance import Maintenance
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

    @property
    def context(self) -> ProcedureContext:
        record = JobRecord(self.bench.as_cell, self.archive, start_command(unit_mode=2))
        return ProcedureContext(
            self.bench.as_cell,
            self.bench.calibrations,
            self.board,
            self.pauses,
            record,
            self.bench.cell.config.recipes[0],
        )

    def answer(self, **answers: Any) -> None:
        """What the workers return instead of working."""
        for name, value in answers.items():
            self.bench.cell.workers.answers[name] = value

    def job(self, number: int) -> Maintenance:
        command = start_command(unit_mode=2, recipe_id=number, order="OP-3")
        order = procedure_order(number, self.bench.cell.config)
        assert order is not None
        return Maintenance(
            self.bench.as_cell,
            self.archive,
            self.board,
            self.bench.calibrations,
            order=order,
            command=command,
        )

    async def audit(self) -> list[tuple[str, str, dict[str, Any]]]:
        def read(store: RunStore) -> list[tuple[str, str, dict[str, Any]]]:
            with store._database.read() as session:
                rows = session.scalars(select(AuditRow).order_by(AuditRow.id)).all()
                return [(row.actor, row.action, row.detail) for row in rows]

        return await self.archive.do(read)
