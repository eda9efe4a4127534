"""What can be asked of a run store: its records, without a change."""

from datetime import datetime

from cellctl.records.database import reading, rows, schema
from cellctl.records.database.sealing import ledger
from cellctl.records.database.sealing.sealed import RUN
from cellctl.records.database.sessions import Database
from cellctl.records.entries import Alarm, AuditEntry, Calibration, Phase, RunHead, RunRecord
from cellctl.records.run_filter import AlarmFilter
from cellctl.records.trend import Sample

LINE_SEQ = "line_seq"
"""Name of the value that remembers the line's last command number."""


class StoredRecords:
    """Reads records; whoever derives from it opens the database."""

    _database: Database

    def active_alarms(self) -> list[Alarm]:
        """Alarms nobody has acknowledged, the oldest first."""
        with self._database.read() as session:
            return [rows.to_entry(row, Alarm) for row in session.scalars(rows.active_alarm_rows())]

    def newest_time(self) -> datetime | None:
        """When the newest record was written; None in an empty store."""
        with self._database.read() as session:
            return reading.newest_time(session)

    def calibrations(self, kind: str = "", limit: int | None = None) -> list[Calibration]:
        """Every calibration that was ever stored, or the newest ones, of one kind; newest first."""
        with self._database.read() as session:
            return reading.calibrations(session, kind, limit)

    def audit_log(self) -> list[AuditEntry]:
        """Every entry of the audit log, oldest first."""
        with self._database.read() as session:
            return reading.audit_log(session)

    def newest_audit(self, limit: int) -> list[AuditEntry]:
        """The newest entries of the audit log, newest first."""
        with self._database.read() as session:
            return reading.newest_audit(session, limit)

    def audit_of_command(self, key: str) -> list[AuditEntry]:
        """Entries of the audit log about the command of the page with this key, oldest first."""
        with self._database.read() as session:
            return reading.audit_of_command(session, key)

    def alarms(self, wanted: AlarmFilter, limit: int) -> list[Alarm]:
        """The newest of the wanted alarms, newest first."""
        with self._database.read() as session:
            return reading.alarms(session, wanted, limit)

    def alarm_count(self, wanted: AlarmFilter) -> int:
        """How many alarms are wanted."""
        with self._database.read() as session:
            return reading.alarm_count(session, wanted)

    def alarm(self, number: int) -> Alarm | None:
        """The alarm with this id; None where there is none."""
        with self._database.read() as session:
            return reading.alarm(session, number)

    def calibration(self, identity: str) -> Calibration | None:
        """The calibration with this id; None where none was ever stored."""
        with self._database.read() as session:
            return reading.calibration(session, identity)

    def is_as_sealed(self, run: int) -> bool:
        """Whether a closed run is as it was sealed; False for one that has no seal.

        The run alone: ``RunStore.verify`` goes through the whole chain, and through the files.
        """
        with self._database.read() as session:
            return ledger.is_as_sealed(session, RUN, run)

    def line_seq(self) -> int | None:
        """The last command number of the line before this start."""
        with self._database.read() as session:
            row = session.get(schema.ValueRow, LINE_SEQ)
            return None if row is None else row.value

    def runs(
        self, limit: int = 50, serial: str | None = None, mate_serial: str | None = None
    ) -> list[RunHead]:
        """The newest runs, newest first; of one serial number, or joined to one, if given."""
        with self._database.read() as session:
            return reading.run_heads(session, limit, serial, mate_serial)

    def good_parts(self) -> int:
        """Runs of Production that ended with a good part."""
        with self._database.read() as session:
            return reading.good_parts(session)

    def figure_keys(self) -> list[str]:
        """Keys of all figures that any run has."""
        with self._database.read() as session:
            return reading.figure_keys(session)

    def figure_history(
        self, key: str, recipe_id: int | None = None, limit: int = 200
    ) -> tuple[list[Sample], str]:
        """A figure in each of the newest finished runs of Production, oldest first; its unit."""
        with self._database.read() as session:
            return reading.figure_history(session, key, recipe_id, limit)

    def run(self, number: int) -> RunRecord:
        """One run with everything; raises ``RunUnknown``."""
        with self._database.read() as session:
            return reading.read_run(session, number)

    def cell_alarms(self, begin: datetime, end: datetime | None) -> list[Alarm]:
        """Alarms of no run, such as a lost line, that came or stood from ``begin`` to ``end``."""
        with self._database.read() as session:
            return reading.cell_alarms(session, begin, end)

    def last_phase(self, run: int) -> Phase | None:
        """The phase that a run began last; None where it has begun none."""
        with self._database.read() as session:
            return reading.last_phase(session, run)
