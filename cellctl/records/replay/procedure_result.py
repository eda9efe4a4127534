"""The result of a procedure as it is computed today, beside what its run has recorded."""

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

from cellctl.calibration.checks import checks_from_record
from cellctl.errors.records.store import NotReplayable
from cellctl.records.entries import Figure
from cellctl.records.figures import Limit, figure
from cellctl.records.replay.recorded_run import RecordedRun
from cellctl.records.replay.replayed import Replayed, compare_documents, solved

STORED = "calibration"
"""Document: which calibration a procedure has stored."""
_NO_KEY = re.compile(r"[^a-z0-9]+")
"""What stands between the words of a key; keys have dots of their own."""
_CHECKS = "checks"


def check_figures(name: str, record: Mapping[str, Any]) -> Iterator[Figure]:
    """The checks of a result of this name, as any run has its figures."""
    used: Counter[str] = Counter()
    # What a process of another package gives need not have any.
    for check in checks_from_record(record.get(_CHECKS, ())):
        key = f"{name}.{_NO_KEY.sub('_', check.name.lower()).strip('_')}"
        # A residual in mm and one in degrees may have one name: neither may hide the other.
        used[key] += 1
        if used[key] > 1:
            key = f"{key}_{used[key]}"
        yield figure(key, check.value, check.unit, label=check.name, limit=Limit(*check.bounds))


def compare_result(run: RecordedRun, name: str, computed: Mapping[str, Any]) -> Iterator[Replayed]:
    """Every number of a result: its checks beside the figures of the run, the others beside the
    calibration that was stored, where it passed.

    ``computed`` is the record that would be stored under this name today.
    """
    for entry in check_figures(name, computed):
        recorded = run.record.value(entry.key)
        yield Replayed(name, entry.label, entry.unit, recorded, entry.value, solved(recorded))
    stored = run.record.document(STORED)
    # A result that did not pass is put aside and not stored: its figures are all that the run has.
    if stored.get("item") != name:
        return
    if stored["id"] not in run.calibrations:
        raise NotReplayable(f"calibration {name} of this run is not in the store")
    was = run.calibrations[stored["id"]].record
    yield from compare_documents(name, _without_checks(was), _without_checks(computed))


def _without_checks(record: Mapping[str, Any]) -> Mapping[str, Any]:
    return {key: value for key, value in record.items() if key != _CHECKS}
