"""Which faults cost which calibrations, and what is left on record."""

from pathlib import Path

import pytest
from sqlalchemy import select

from cellctl.errors import CellError
from cellctl.errors.calibration import CalibrationInvalidated
from cellctl.errors.force import ForceLimitExceeded, MatingOverforce, SensorSilent
from cellctl.errors.robot import ControllerFault, HeadMoved, MotionAborted
from cellctl.errors.vision import ResidualsTooLarge
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.schema import AuditRow, CalibrationRow
from cellctl.records.store import RunStore
from cellctl.runtime.invalidation import INVALIDATED_BY, invalidate_after
from tests.unit.cell.bench import Bench
from tests.unit.runtime.test_calibration_folder import HOUR


async def rows(archive: AsyncRunStore) -> tuple[list[CalibrationRow], list[AuditRow]]:
    def read(store: RunStore) -> tuple[list[CalibrationRow], list[AuditRow]]:
        with store._database.read() as session:
            return list(session.scalars(select(CalibrationRow))), list(
                session.scalars(select(AuditRow))
            )

    return await archive.do(read)


@pytest.mark.parametrize("fault", sorted(INVALIDATED_BY, key=lambda cls: cls.number))
async def test_after_these_production_is_refused_with_the_reason(
    bench: Bench, tmp_path: Path, fault: type[CellError]
) -> None:
    archive = AsyncRunStore(tmp_path / "store")
    try:
        await invalidate_after(fault("aux_1 met the deck"), bench.calibrations, archive)
        refused = bench.calibrations.fault(HOUR)
        assert isinstance(refused, CalibrationInvalidated)
        assert f"F{fault.number}" in refused.detail
        assert "aux_1 met the deck" in refused.detail
        calibrations, audit = await rows(archive)
    finally:
        archive.close()
    assert {row.kind for row in calibrations} <= set(INVALIDATED_BY[fault])
    assert all(row.invalidated and "met the deck" in str(row.invalidated_reason)
               for row in calibrations)  # fmt: skip
    assert [(row.actor, row.action) for row in audit] == [("cell", "calibrations invalidated")]


@pytest.mark.parametrize("fault", [SensorSilent, MotionAborted, HeadMoved, ResidualsTooLarge])
async def test_other_faults_cost_nothing(
    bench: Bench, tmp_path: Path, fault: type[CellError]
) -> None:
    archive = AsyncRunStore(tmp_path / "store")
    try:
        await invalidate_after(fault(), bench.calibrations, archive)
        assert await rows(archive) == ([], [])
    finally:
        archive.close()
    assert bench.calibrations.fault(HOUR) is None


def test_what_may_have_moved_a_head_costs_its_place() -> None:
    for fault in (ControllerFault, ForceLimitExceeded):
        assert "board_transfer" in INVALIDATED_BY[fault]
    assert "stop_latency" in INVALIDATED_BY[MatingOverforce]
