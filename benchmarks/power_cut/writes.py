"""Each kind of write that the cell acknowledges, and how to find it again after a power cut."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from datetime import UTC, datetime, timedelta
from pathlib import Path

from cellctl.calibration.store.envelope import StoredCalibration, read_stored, write_stored
from cellctl.calibration.store.marker import mark_invalid, marker
from cellctl.records import RunResult, RunStore
from cellctl.records.entered.gauges import GAUGE_HOLES
from cellctl.records.entries import Document
from cellctl.records.figures import figure

_MADE = datetime(2026, 1, 1, tzinfo=UTC)


class Write(ABC):
    """One kind of write. ``do`` returns when it is acknowledged, with what names it."""

    def __init__(self, folder: Path) -> None:
        self.store = RunStore(folder / "data" / "store")
        self.calibrations = folder / "data" / "calibration"

    @abstractmethod
    def do(self, count: int) -> str:
        """Write number ``count``; what names it afterwards."""

    @abstractmethod
    def is_there(self, name: str) -> bool:
        """Whether the write of this name is in the records."""

    def _open_run(self, count: int) -> int:
        return self.store.start_run(
            process="power-cut",
            serial=f"S{count}",
            recipe_id=1,
            recipe_name="records",
            recipe_hash="0",
            mode="production",
            software="0",
            config_hash="0",
            calibration_ids={},
            simulated=True,
        )


class Opening(Write):
    """A run is opened before anything moves."""

    def do(self, count: int) -> str:
        return str(self._open_run(count))

    def is_there(self, name: str) -> bool:
        return any(head.number == int(name) for head in self.store.runs(limit=100_000))


class Details(Write):
    """A figure of a run, in a phase."""

    def do(self, count: int) -> str:
        run = self._open_run(count)
        self.store.begin_phase(run, 10, "measure")
        self.store.add(run, figure("power.cut", float(count), "mm"))
        return f"{run} {count}"

    def is_there(self, name: str) -> bool:
        run, count = map(int, name.split())
        return any(entry.value == count for entry in self.store.run(run).figures)


class Artefact(Write):
    """A file of a run."""

    def do(self, count: int) -> str:
        run = self._open_run(count)
        data = f"curve {count} ".encode() * 2000
        return f"{run} {self.store.add_artefact(run, 'curve', data, 'text/plain')}"

    def is_there(self, name: str) -> bool:
        run, sha256 = name.split()
        listed = any(entry.sha256 == sha256 for entry in self.store.run(int(run)).artefacts)
        return listed and bool(self.store.artefacts.get(sha256))


class Close(Write):
    """The result of a run."""

    def do(self, count: int) -> str:
        run = self._open_run(count)
        self.store.close_run(run, RunResult.GOOD)
        return str(run)

    def is_there(self, name: str) -> bool:
        return self.store.run(int(name)).head.result == RunResult.GOOD


class PlugGauge(Write):
    """A plug gauge of a closed run."""

    def do(self, count: int) -> str:
        run = self._open_run(count)
        holes = {"P1": {"least_mm": 5.8, "most_mm": 6.0}}
        self.store.add(run, Document(GAUGE_HOLES, holes))
        self.store.close_run(run, RunResult.GOOD)
        self.store.set_gauge(run, "P1", 5.97, "operator")
        return str(run)

    def is_there(self, name: str) -> bool:
        return bool(self.store.run(int(name)).gauges)


class RaisedAlarm(Write):
    """An alarm."""

    def do(self, count: int) -> str:
        return str(self.store.add_alarm(None, 200 + count % 100, f"alarm {count}"))

    def is_there(self, name: str) -> bool:
        return any(alarm.id == int(name) for alarm in self.store.active_alarms())


class Acknowledgement(Write):
    """An alarm that somebody has acknowledged."""

    def do(self, count: int) -> str:
        number = 10_000 + count
        self.store.add_alarm(None, number, "acknowledged")
        self.store.acknowledge_alarms(number, "operator")
        return str(number)

    def is_there(self, name: str) -> bool:
        # Never to be found active again: the alarm went to the disk before its acknowledgement.
        return not any(alarm.number == int(name) for alarm in self.store.active_alarms())


class StoredResult(Write):
    """A calibration: its file, and its row in the store."""

    def do(self, count: int) -> str:
        stored = _calibration(count)
        write_stored(self.calibrations, stored)
        self.store.add_calibration(stored)
        return stored.kind

    def is_there(self, name: str) -> bool:
        written = read_stored(self.calibrations, name)
        return any(kept.id == written.id for kept in self.store.calibrations())


class Invalidation(Write):
    """A calibration that an event has made void."""

    def do(self, count: int) -> str:
        stored = _calibration(count)
        write_stored(self.calibrations, stored)
        mark_invalid(self.calibrations, stored.kind, "collision", _MADE)
        self.store.invalidate_calibration(stored, "collision")
        return stored.kind

    def is_there(self, name: str) -> bool:
        rows = [row for row in self.store.calibrations() if row.kind == name]
        noted = bool(rows) and rows[0].invalidated is not None
        return noted and marker(self.calibrations, name).exists()


class AuditLine(Write):
    """A line of the audit log."""

    def do(self, count: int) -> str:
        self.store.audit("operator", f"action {count}")
        return f"action {count}"

    def is_there(self, name: str) -> bool:
        return any(entry.action == name for entry in self.store.audit_log())


class LineNumber(Write):
    """The number of the line's last command, without which it would be obeyed twice."""

    def do(self, count: int) -> str:
        self.store.note_line_seq(count)
        return str(count)

    def is_there(self, name: str) -> bool:
        return (self.store.line_seq() or 0) >= int(name)


KINDS: Mapping[str, type[Write]] = {
    "run opened": Opening,
    "figure of a run": Details,
    "file of a run": Artefact,
    "run closed": Close,
    "plug gauge": PlugGauge,
    "alarm": RaisedAlarm,
    "acknowledgement": Acknowledgement,
    "calibration": StoredResult,
    "invalidation": Invalidation,
    "audit line": AuditLine,
    "number of the line": LineNumber,
}


def _calibration(count: int) -> StoredCalibration:
    return StoredCalibration(
        kind=f"kind_{count}",
        record={"value": count},
        made=_MADE,
        valid_until=_MADE + timedelta(days=365),
        software="0",
        serial_number="",
    )
