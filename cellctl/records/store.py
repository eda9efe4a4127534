"""The run store: what the cell did, to whom, with what, and how it ended.

A folder with ``store.sqlite`` and ``files/``. All methods block, belong to one thread and raise the
8xx faults. A call that returns is on the disk.
"""

from collections.abc import Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

from sqlalchemy import select

from cellctl.calibration.store.envelope import StoredCalibration
from cellctl.clock import utc_now
from cellctl.errors.records import ValueRefused
from cellctl.records import ledger, reading
from cellctl.records.artefacts import ArtefactFolder
from cellctl.records.database import Database
from cellctl.records.entries import Alarm, Calibration, RunHead, RunRecord, RunResult
from cellctl.records.ownership import Ownership
from cellctl.records.rows import active_alarm_rows, close, existing_run, floats, open_run
from cellctl.records.schema import (
    AlarmRow,
    ArtefactRow,
    AuditRow,
    CalibrationRow,
    GaugeRow,
    IterationRow,
    MeasurementRow,
    RunRow,
    ValueRow,
)

_GAUGE_RANGE_MM = (0.5, 50.0)
_LINE_SEQ = "line_seq"


class RunStore:
    """One writer: the daemon. Commands of the operator may add gauge results beside it."""

    def __init__(self, path: Path, *, create: bool = True) -> None:
        """Open the store in a folder, or create it; raises ``StoreUnavailable``."""
        self.path = path
        self._database = Database(path / "store.sqlite", create=create)
        self.artefacts = ArtefactFolder(path / "files")
        self._ownership = Ownership(path / "owner.lock")

    def close(self) -> None:
        """Drop the connection. Open runs stay open, to be found as interrupted."""
        self._database.close()
        self._ownership.release()

    def mark_interrupted(self) -> list[int]:
        """Become the owner and close what an earlier owner left open; the numbers of those runs.

        Raises ``StoreInUse`` while another daemon lives.
        """
        self._ownership.take()
        with self._database.write() as session:
            rows = session.scalars(select(RunRow).where(RunRow.ended.is_(None))).all()
            for row in rows:
                close(session, row, RunResult.INTERRUPTED, None, None)
            return [row.number for row in rows]

    def start_run(
        self,
        *,
        serial: str,
        recipe_id: int,
        recipe_name: str,
        recipe_hash: str,
        mode: str,
        software: str,
        config_hash: str,
        calibration_ids: Mapping[str, str],
        simulated: bool,
        operator: str = "",
    ) -> int:
        """Open a run, before anything moves; its number."""
        row = RunRow(
            serial=serial,
            recipe_id=recipe_id,
            recipe_name=recipe_name,
            recipe_hash=recipe_hash,
            mode=mode,
            operator=operator,
            software=software,
            config_hash=config_hash,
            simulated=simulated,
            calibration_ids=dict(calibration_ids),
            started=utc_now(),
        )
        with self._database.write() as session:
            session.add(row)
        return row.number

    def add_measurement(
        self,
        run: int,
        kind: str,
        *,
        pose_mm_deg: Sequence[float],
        sigma_mm_deg: Sequence[float],
        residual_um: float,
        frames: int,
        detail: Mapping[str, Any] | None = None,
    ) -> None:
        """A measured pose as X, Y, Z, A, B, C; ``residual_um`` is the rms over the holes."""
        self._add(
            run,
            MeasurementRow(
                run=run,
                time=utc_now(),
                kind=kind,
                pose_mm_deg=floats(pose_mm_deg),
                sigma_mm_deg=floats(sigma_mm_deg),
                residual_um=floats([residual_um])[0],
                frames=frames,
                detail=dict(detail or {}),
            ),
        )

    def add_iteration(
        self,
        run: int,
        iteration: int,
        *,
        error_mm_deg: Sequence[float],
        sigma_mm_deg: Sequence[float],
        threshold_mm_deg: Sequence[float],
        frames: int,
        residual_um: float,
        converged: bool,
        correction_mm_deg: Sequence[float] = (),
    ) -> None:
        """One pass of the loop; six components each, the correction empty when there was none."""
        self._add(
            run,
            IterationRow(
                run=run,
                time=utc_now(),
                iteration=iteration,
                error_mm_deg=floats(error_mm_deg),
                sigma_mm_deg=floats(sigma_mm_deg),
                threshold_mm_deg=floats(threshold_mm_deg),
                frames=frames,
                residual_um=floats([residual_um])[0],
                converged=converged,
                correction_mm_deg=floats(correction_mm_deg),
            ),
        )

    def add_artefact(self, run: int, name: str, data: bytes, media_type: str) -> str:
        """A file of the run; its SHA-256. The bytes are on the disk before the row is."""
        sha256 = self.artefacts.put(data)
        row = ArtefactRow(
            run=run,
            time=utc_now(),
            name=name,
            sha256=sha256,
            size=len(data),
            media_type=media_type,
        )
        self._add(run, row)
        return sha256

    def set_mating(self, run: int, mating: Mapping[str, Any]) -> None:
        """Figures of the mating: plain numbers, texts and lists. Later keys replace earlier."""
        with self._database.write() as session:
            row = open_run(session, run)
            row.mating = {**(row.mating or {}), **mating}

    def close_run(
        self,
        run: int,
        result: RunResult | str,
        *,
        fault_number: int | None = None,
        fault: str | None = None,
    ) -> None:
        """Close and seal; raises ``RunClosed`` the second time."""
        with self._database.write() as session:
            close(session, open_run(session, run), RunResult(result), fault_number, fault)

    def set_gauge(self, run: int, hole: str, diameter_mm: float, source: str) -> None:
        """A plug-gauge result, also after the run was closed. A later one counts, both stay."""
        least, greatest = _GAUGE_RANGE_MM
        if not least <= diameter_mm <= greatest:
            raise ValueRefused(f"plug gauge {diameter_mm:g} mm, allowed {least:g} to {greatest:g}")
        if not hole or not source:
            raise ValueRefused("a gauge result needs its hole and who measured it")
        row = GaugeRow(
            run=run, time=utc_now(), hole=hole, diameter_mm=round(diameter_mm, 3), source=source
        )
        with self._database.write() as session:
            existing_run(session, run)
            session.add(row)
            session.flush()
            ledger.seal(session, ledger.GAUGE, row.id, row.time)

    def add_alarm(self, run: int | None, number: int, text: str) -> int:
        """A fault or warning; stays active until acknowledged, over restarts too."""
        row = AlarmRow(run=run, time=utc_now(), number=number, text=text)
        with self._database.write() as session:
            session.add(row)
        return row.id

    def acknowledge_alarms(self, number: int, who: str) -> int:
        """Acknowledge every active alarm with a fault number; how many there were."""
        with self._database.write() as session:
            rows = session.scalars(active_alarm_rows().where(AlarmRow.number == number)).all()
            for row in rows:
                row.acknowledged, row.acknowledged_by = utc_now(), who
            return len(rows)

    def active_alarms(self) -> list[Alarm]:
        """Alarms nobody has acknowledged, the oldest first."""
        with self._database.read() as session:
            return [reading.convert(row, Alarm) for row in session.scalars(active_alarm_rows())]

    def add_calibration(self, stored: StoredCalibration) -> None:
        """Keep a calibration for good; the same one again is no change."""
        row = CalibrationRow(
            id=stored.id,
            kind=stored.kind,
            serial_number=stored.serial_number,
            software=stored.software,
            made=stored.made,
            valid_until=stored.valid_until,
            record=dict(stored.record),
        )
        with self._database.write() as session:
            if session.get(CalibrationRow, stored.id) is None:
                session.add(row)

    def invalidate_calibration(self, stored: StoredCalibration, reason: str) -> None:
        """Note that a calibration is worthless from now on; the first reason stays."""
        self.add_calibration(stored)
        with self._database.write() as session:
            row = session.get_one(CalibrationRow, stored.id)
            if row.invalidated is None:
                row.invalidated, row.invalidated_reason = utc_now(), reason

    def newest_time(self) -> datetime | None:
        """When the newest record was written; None in an empty store."""
        with self._database.read() as session:
            return reading.newest_time(session)

    def calibrations(self) -> list[Calibration]:
        """Every calibration that was ever stored, newest first."""
        query = select(CalibrationRow).order_by(CalibrationRow.made.desc())
        with self._database.read() as session:
            return [reading.convert(row, Calibration) for row in session.scalars(query)]

    def audit(self, actor: str, action: str, detail: Mapping[str, Any] | None = None) -> None:
        """Append to the audit log."""
        row = AuditRow(time=utc_now(), actor=actor, action=action, detail=dict(detail or {}))
        with self._database.write() as session:
            session.add(row)

    def note_line_seq(self, seq: int) -> None:
        """Remember the last command number of the line, before the command is obeyed."""
        with self._database.write() as session:
            session.merge(ValueRow(name=_LINE_SEQ, value=seq))

    def line_seq(self) -> int | None:
        """The last command number of the line before this start."""
        with self._database.read() as session:
            row = session.get(ValueRow, _LINE_SEQ)
            return None if row is None else row.value

    def runs(self, limit: int = 50, serial: str | None = None) -> list[RunHead]:
        """The newest runs, newest first; of one serial number if given."""
        query = select(RunRow).order_by(RunRow.number.desc()).limit(limit)
        if serial is not None:
            query = query.where(RunRow.serial == serial)
        with self._database.read() as session:
            return [reading.convert(row, RunHead) for row in session.scalars(query)]

    def run(self, number: int) -> RunRecord:
        """One run with everything; raises ``RunUnknown``."""
        with self._database.read() as session:
            return reading.read_run(session, number)

    def verify(self) -> list[str]:
        """Whether anything that is closed was changed: the problems, none if all is well."""
        with self._database.read() as session:
            return list(ledger.problems(session))

    def _add(self, run: int, row: MeasurementRow | IterationRow | ArtefactRow) -> None:
        with self._database.write() as session:
            open_run(session, run)
            session.add(row)
