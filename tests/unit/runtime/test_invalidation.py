"""Which faults cost which calibrations, and what is left on record."""

from datetime import timedelta
from pathlib import Path

import pytest

from cellctl.calibration.store.kind import kinds_invalidated_by
from cellctl.errors import CellError
from cellctl.errors.calibration import CalibrationInvalidated
from cellctl.errors.force import ForceLimitExceeded, LiftOffHeld, SensorSaturated, SensorSilent
from cellctl.errors.robot import ArmOffReference, ControllerFault, HeadMoved, MotionAborted
from cellctl.errors.vision import HeadsMoved, ResidualsTooLarge
from cellctl.processes.deck_to_frame.calibrations import CALIBRATIONS
from cellctl.processes.deck_to_frame.faults import CorrectionDiverging, MatingOverforce
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.entries import AuditEntry, Calibration
from cellctl.records.store import RunStore
from cellctl.runtime.invalidation import invalidate_after
from tests.unit.cell.bench import Bench

HOUR = timedelta(hours=1)
# Written out from what may have been moved, bent or proved wrong, not derived from the kinds.
AGREED: dict[type[CellError], set[str]] = {
    ControllerFault: {"board_transfer", "payload"},
    ArmOffReference: {"base_frame", "board_transfer"},
    HeadsMoved: {"board_transfer"},
    CorrectionDiverging: {"board_transfer"},
    SensorSaturated: {"payload"},
    ForceLimitExceeded: {"board_transfer", "payload"},
    MatingOverforce: {"payload", "stop_latency", "contact_stiffness"},
}


async def rows(archive: AsyncRunStore) -> tuple[list[Calibration], list[AuditEntry]]:
    def read(store: RunStore) -> tuple[list[Calibration], list[AuditEntry]]:
        return store.calibrations(), store.audit_log()

    return await archive.do(read)


FAULTS = sorted(AGREED, key=lambda cls: cls.number)


@pytest.mark.parametrize("fault", FAULTS)
async def test_after_these_production_is_refused_with_the_reason(
    bench: Bench, tmp_path: Path, fault: type[CellError]
) -> None:
    archive = AsyncRunStore(tmp_path / "store")
    try:
        await invalidate_after(fault("aux_1 met the deck"), bench.calibrations, archive)
        refused = bench.calibrations.fault(CALIBRATIONS, HOUR)
        assert isinstance(refused, CalibrationInvalidated)
        assert f"F{fault.number}" in refused.detail
        assert "aux_1 met the deck" in refused.detail
        calibrations, audit = await rows(archive)
    finally:
        archive.close()
    assert {row.kind for row in calibrations} <= AGREED[fault]
    assert all(row.invalidated and "met the deck" in str(row.invalidated_reason)
               for row in calibrations)  # fmt: skip
    assert [(row.actor, row.action) for row in audit] == [("cell", "calibrations invalidated")]


@pytest.mark.parametrize(
    "fault", [SensorSilent, LiftOffHeld, MotionAborted, HeadMoved, ResidualsTooLarge]
)
async def test_other_faults_cost_nothing(
    bench: Bench, tmp_path: Path, fault: type[CellError]
) -> None:
    archive = AsyncRunStore(tmp_path / "store")
    try:
        await invalidate_after(fault(), bench.calibrations, archive)
        assert await rows(archive) == ([], [])
    finally:
        archive.close()
    assert bench.calibrations.fault(CALIBRATIONS, HOUR) is None


def test_every_kind_says_which_faults_invalidate_it() -> None:
    faults = {fault for kind in CALIBRATIONS for fault in kind.invalidated_by}
    found = {
        fault: {kind.name for kind in kinds_invalidated_by(fault(), CALIBRATIONS)}
        for fault in faults
    }
    assert found == AGREED
