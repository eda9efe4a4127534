"""Invalidates, durably, the calibrations that a fault may have made wrong."""

import asyncio
from collections.abc import Sequence
from typing import Any

from cellctl import log
from cellctl.calibration.store.envelope import StoredCalibration
from cellctl.calibration.store.kind import CalibrationKind, kinds_invalidated_by
from cellctl.calibration.store.store import CalibrationStore
from cellctl.errors import CellError
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.store import RunStore

_log = log.get(__name__)


async def invalidate_after(
    fault: CellError, calibrations: CalibrationStore, records: AsyncRunStore
) -> None:
    """Invalidate durably, in folder and run store, what a fault has made worthless.

    Raises ``CalibrationNotStored`` or ``RecordNotWritten``.
    """
    kinds = kinds_invalidated_by(fault, calibrations.kinds)
    if not kinds:
        return
    reason = str(fault)
    # The folder first: it is what production reads, the run store only remembers why.
    found = await asyncio.to_thread(calibrations.invalidate, kinds, reason)
    await _told(found, [stored.kind for stored in found], reason, records)


async def refute(
    kind: CalibrationKind[Any],
    fault: CellError,
    calibrations: CalibrationStore,
    records: AsyncRunStore,
) -> None:
    """Invalidate durably a calibration that a newer measurement contradicts, made or not.

    Raises ``CalibrationNotStored`` or ``RecordNotWritten``.
    """
    reason = str(fault)
    found = await asyncio.to_thread(calibrations.refute, kind, reason)
    await _told([] if found is None else [found], [kind.name], reason, records)


async def _told(
    found: Sequence[StoredCalibration], names: Sequence[str], reason: str, records: AsyncRunStore
) -> None:
    _log.warning("calibrations invalidated", items=list(names), reason=reason)
    for stored in found:
        await records.do(RunStore.invalidate_calibration, stored, reason)
    detail = {"items": list(names), "reason": reason}
    await records.do(RunStore.audit, "cell", "calibrations invalidated", detail)
