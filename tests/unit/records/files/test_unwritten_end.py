"""The end of a run that its database did not take is written at the next start."""

from datetime import UTC, datetime
from pathlib import Path

import pytest

from cellctl.errors.records.store import RecordNotWritten
from cellctl.records.entries import RunResult
from cellctl.records.files.unwritten_end import UnwrittenEnd, UnwrittenEnds
from cellctl.records.store import RunStore
from tests.unit.records.conftest import start

ENDED = datetime(2026, 3, 1, 12, 0, 5, tzinfo=UTC)
END = UnwrittenEnd(ENDED, RunResult.ABORTED, 704, "F704 line lost; F803 disk is full")


def test_the_next_start_closes_the_run_with_it(tmp_path: Path) -> None:
    store = RunStore(tmp_path)
    known, killed = start(store), start(store)
    store.begin_phase(known, 30, "search")
    store.keep_end(known, END)
    store.close()
    later = RunStore(tmp_path)
    assert later.mark_interrupted() == [known, killed], "an arm may press since either"
    record = later.run(known)
    head = record.head
    assert (head.ended, head.result, head.fault_number) == (ENDED, RunResult.ABORTED, 704)
    assert head.fault == END.fault
    assert record.phases[-1].ended == ENDED
    assert later.run(killed).head.result == RunResult.INTERRUPTED
    assert later.verify() == []
    assert not list((tmp_path / "unfinished").iterdir())
    later.close()


@pytest.mark.parametrize(
    ("was", "edited"),
    [('"aborted"', '"good"'), ("+00:00", ""), ("{", "["), ('"fault_number"', '"number"')],
)
def test_what_somebody_edited_is_no_end(tmp_path: Path, was: str, edited: str) -> None:
    ends = UnwrittenEnds(tmp_path)
    ends.keep(1, END)
    assert ends.read(1) == END
    (file,) = tmp_path.iterdir()
    file.write_text(file.read_text().replace(was, edited))
    assert ends.read(1) is None


def test_the_draft_of_a_crash_goes_with_the_others(tmp_path: Path) -> None:
    ends = UnwrittenEnds(tmp_path)
    ends.keep(1, END)
    (tmp_path / "2.end.json.part").write_text("{")
    (tmp_path / "3.mcap").write_text("a recording, which is removed by its own")
    ends.clear()
    assert [file.name for file in tmp_path.iterdir()] == ["3.mcap"]


def test_a_disk_that_takes_nothing_is_a_fault(tmp_path: Path) -> None:
    (tmp_path / "ends").write_text("no folder")
    with pytest.raises(RecordNotWritten, match="end of run 1"):
        UnwrittenEnds(tmp_path / "ends").keep(1, END)
