"""The run store: what the cell did, with which part, with which figures, and how it ended.

A folder with ``store.sqlite`` and ``files/``. All methods block, belong to one thread and raise the
8xx faults. A call that returns is on the disk.
"""

from collections.abc import Mapping
from datetime import datetime
from pathlib import Path
from typing import Any, BinaryIO

from cellctl.calibration.store.envelope import StoredCalibration
from cellctl.clock import utc_now
from cellctl.errors.records.store import RecordAltered
from cellctl.records.database import reading, rows, schema
from cellctl.records.database.claimed_version import foreign_parts
from cellctl.records.database.schema_version import FILE, SCHEMA_VERSION
from cellctl.records.database.sealing import ledger, sealed, sealed_details
from cellctl.records.database.sealing.written_details import WrittenDetails
from cellctl.records.database.sessions import LOCK_WAIT_S, Database
from cellctl.records.database.stored_records import LINE_SEQ, StoredRecords
from cellctl.records.entered.gauges import require_gauge, require_plausible
from cellctl.records.entries import RunDetail, RunResult
from cellctl.records.files.artefacts import ArtefactFolder
from cellctl.records.files.mcap_reading import MEDIA_TYPE as MCAP_MEDIA_TYPE
from cellctl.records.files.mcap_reading import has_messages
from cellctl.records.files.unfinished import MOTION, UnfinishedRecordings
from cellctl.records.files.unwritten_end import UnwrittenEnd, UnwrittenEnds
from cellctl.records.ownership import Ownership
from cellctl.records.seals import LedgerHead


class RunStore(StoredRecords):
    """One writer: the daemon. Commands of the operator may add gauge results beside it."""

    def __init__(
        self, path: Path, *, create: bool = True, lock_wait_s: float = LOCK_WAIT_S
    ) -> None:
        """Open the store in a folder, migrate an older one, or create it.

        A write waits ``lock_wait_s`` for another writer. Raises ``StoreUnavailable``,
        ``StoreTooNew``, ``StoreLocked``; ``StoreHeldByEarlierVersion`` for an older one in use.
        """
        self.path = path
        self._ownership = Ownership(path / "owner.lock")
        self._database = Database(
            path / FILE, create=create, alone=self._ownership.alone, lock_wait_s=lock_wait_s
        )
        self.artefacts = ArtefactFolder(path / "files")
        self._unfinished = UnfinishedRecordings(path / "unfinished")
        self._ends = UnwrittenEnds(path / "unfinished")
        self._written: dict[int, WrittenDetails | None] = {}
        """What this store has written of each run that it has opened, by its number."""

    def close(self) -> None:
        """Drop the connection. Open runs stay open, to be found as interrupted."""
        self._database.close()
        self._ownership.release()

    def mark_interrupted(self) -> list[int]:
        """Become the owner and close what an earlier owner left open; the numbers of those runs.

        A run whose end an earlier owner has kept is closed with that, any other as interrupted.
        Raises ``StoreInUse`` while another daemon lives.
        """
        self._ownership.take()
        left_open = []
        with self._database.write() as session:
            found = rows.open_runs(session)
            for row in found:
                if (data := self._unfinished.read(row.number)) is not None and has_messages(data):
                    kept = self.artefacts.put(data), len(data)
                    recording = rows.artefact(row.number, MOTION, MCAP_MEDIA_TYPE, *kept)
                    sealed_details.add_details(session, row, [recording], None)
                if (end := self._ends.read(row.number)) is not None:
                    known = end.result, end.fault_number, end.fault
                    rows.close(session, row, *known, ended=end.ended)
                else:
                    rows.close(session, row, RunResult.INTERRUPTED, None, None)
                # Both: the arm may press since then, and no alarm reached a disk that took nothing.
                left_open.append(row.number)
        # Those of runs that were closed too: a daemon may die between storing and removing.
        self._unfinished.clear()
        self._ends.clear()
        return left_open

    def keep_end(self, run: int, end: UnwrittenEnd) -> None:
        """Keep how a run ended that could not be closed; ``mark_interrupted`` closes it so."""
        self._ends.keep(run, end)

    def start_run(
        self,
        *,
        process: str,
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
        row = schema.RunRow(
            process=process,
            record_schema=SCHEMA_VERSION,
            serial=serial,
            recipe_id=recipe_id,
            recipe_name=recipe_name,
            recipe_hash=recipe_hash,
            mode=mode,
            operator=operator,
            software=software,
            config_hash=config_hash,
            simulated=simulated,
            calibration_ids=calibration_ids,
            started=utc_now(),
        )
        with self._database.write() as session:
            session.add(row)
            # Sealed at once: a run that somebody deletes later leaves a gap.
            ledger.seal(session, sealed.OPENING, row, row.started)
        self._written[row.number] = WrittenDetails()
        return row.number

    def add(self, run: int, *details: RunDetail) -> None:
        """Figures, poses, passes and documents of the phase that a run is in; all or none."""
        with self._database.write() as session:
            row = rows.open_run(session, run)
            phase = rows.open_phase(session, run)
            phase_id = None if phase is None else phase.id
            new = [rows.to_row(entry, run, phase_id) for entry in details]
            written = sealed_details.add_details(session, row, new, self._written.get(run))
        self._written[run] = written

    def begin_phase(self, run: int, number: int, label: str) -> None:
        """End the phase that a run is in, if there is one, and begin another."""
        now = utc_now()
        with self._database.write() as session:
            row = rows.open_run(session, run)
            before = rows.open_phase(session, run)
            if before is not None:
                before.ended = now
            new = schema.PhaseRow(run=run, number=number, label=label, began=now)
            written = sealed_details.add_details(session, row, [new], self._written.get(run))
        self._written[run] = written

    def add_artefact(self, run: int, name: str, data: bytes, media_type: str) -> str:
        """A file of the run; its SHA-256. The bytes are on the disk before the row is."""
        # In this order a power cut leaves a file without a row at worst, no row without its file.
        sha256 = self.artefacts.put(data)
        with self._database.write() as session:
            row = rows.open_run(session, run)
            new = rows.artefact(run, name, media_type, sha256, len(data))
            written = sealed_details.add_details(session, row, [new], self._written.get(run))
        self._written[run] = written
        return sha256

    def open_recording(self, run: int) -> BinaryIO:
        """A file for the motion of an open run; one that is left open is found after a crash."""
        return self._unfinished.open(run)

    def keep_recording(self, run: int) -> None:
        """Make the recording of a run, which is complete, one of its files."""
        if (data := self._unfinished.read(run)) is not None:
            self.add_artefact(run, MOTION, data, MCAP_MEDIA_TYPE)
            self._unfinished.remove(run)

    def close_run(
        self,
        run: int,
        result: RunResult | str,
        *,
        fault_number: int | None = None,
        fault: str | None = None,
    ) -> None:
        """Close and seal; raises ``RunClosed`` the second time.

        Raises ``RecordAltered`` after closing a run of which something was changed beside this
        store while it was open; such a run is not good.
        """
        result, altered = RunResult(result), None
        with self._database.write() as session:
            row = rows.open_run(session, run)
            written = self._written.get(run)
            if written is not None and sealed_details.altered(session, row, written):
                altered = RecordAltered(f"run {run}")
                if result is RunResult.GOOD:
                    result, fault_number, fault = RunResult.BAD, altered.number, str(altered)
            rows.close(session, row, result, fault_number, fault)
        self._written.pop(run, None)
        if altered is not None:
            raise altered

    def set_gauge(
        self, run: int, hole: str, diameter_mm: float, source: str, gauge_id: str = ""
    ) -> datetime:
        """A plug-gauge result, also after the run was closed, and its time; the last one counts.

        Raises ``ValueRefused``, ``GaugeRefused`` or ``RunUnknown``.
        """
        require_plausible(hole, diameter_mm, source)
        now, mm = utc_now(), round(diameter_mm, 3)
        row = schema.GaugeRow(
            run=run, time=now, hole=hole, diameter_mm=mm, source=source, gauge_id=gauge_id
        )
        with self._database.write() as session:
            require_gauge(reading.read_run(session, run), hole, mm)
            session.add(row)
            ledger.seal(session, sealed.GAUGE, row, now)
        return now

    def add_alarm(self, run: int | None, number: int, text: str) -> int:
        """A fault or warning; stays active until acknowledged, over restarts too."""
        row = schema.AlarmRow(run=run, time=utc_now(), number=number, text=text)
        with self._database.write() as session:
            session.add(row)
            ledger.seal(session, sealed.ALARM, row, row.time)
        return row.id

    def acknowledge_alarms(self, number: int, who: str, first: int | None = None) -> int:
        """Acknowledge the ``first`` active alarms with a fault number, or all; how many."""
        with self._database.write() as session:
            active = rows.active_alarm_rows().where(schema.AlarmRow.number == number)
            found = session.scalars(active.limit(first)).all()
            for row in found:
                now = utc_now()
                row.acknowledged, row.acknowledged_by = now, who
                ledger.seal(session, sealed.ACKNOWLEDGEMENT, row, now)
            return len(found)

    def add_calibration(self, stored: StoredCalibration) -> None:
        """Keep a calibration for good; the same one again is no change."""
        row = rows.calibration(stored)
        with self._database.write() as session:
            if session.get(schema.CalibrationRow, stored.id) is None:
                session.add(row)
                ledger.seal(session, sealed.CALIBRATION, row, utc_now())

    def invalidate_calibration(self, stored: StoredCalibration, reason: str) -> None:
        """Note that a calibration is worthless from now on; the first reason stays."""
        self.add_calibration(stored)
        with self._database.write() as session:
            row = session.get_one(schema.CalibrationRow, stored.id)
            if row.invalidated is None:
                now = utc_now()
                row.invalidated, row.invalidated_reason = now, reason
                ledger.seal(session, sealed.INVALIDATION, row, now)

    def audit(self, actor: str, action: str, detail: Mapping[str, Any] | None = None) -> None:
        """Append to the audit log."""
        row = schema.AuditRow(time=utc_now(), actor=actor, action=action, detail=detail or {})
        with self._database.write() as session:
            session.add(row)
            ledger.seal(session, sealed.AUDIT, row, row.time)

    def note_line_seq(self, seq: int) -> None:
        """Remember the last command number of the line, before the command is obeyed."""
        with self._database.write() as session:
            row = session.merge(schema.ValueRow(name=LINE_SEQ, value=seq))
            ledger.seal(session, sealed.VALUE, row, utc_now())

    def verify(self, printed: LedgerHead | None = None) -> list[str]:
        """Whether anything that is sealed was changed: the problems, none if all is well.

        ``printed`` is the head of the ledger on a report, which the ledger must still contain.
        Files are read too: one that is missing or not as it was stored is a problem.
        """
        with self._database.read() as session:
            foreign = [f"the store has {part}" for part in foreign_parts(session.connection())]
            damaged = reading.damaged_files(session, self.artefacts)
            return [*foreign, *ledger.problems(session, printed), *damaged]

    def ledger_head(self) -> LedgerHead:
        """Length and newest hash of the chain."""
        with self._database.read() as session:
            return ledger.head(session)

    def ledger_since(self, seen: LedgerHead | None) -> LedgerHead:
        """As ``ledger_head``; raises ``RecordAltered`` unless the chain still holds an earlier
        one."""
        with self._database.read() as session:
            if seen is not None and not ledger.holds(session, seen):
                raise RecordAltered(f"the ledger no longer holds {seen}, to which it had come")
            return ledger.head(session)
