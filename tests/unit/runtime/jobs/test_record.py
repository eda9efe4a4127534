"""A record that somebody edits while its run is open is no record of a good part."""

import sqlite3
from contextlib import closing
from typing import Never

import pytest

from cellctl.errors.records.store import StoreUnavailable
from cellctl.packml.result import Result
from cellctl.packml.state import State
from cellctl.records.store import RunStore
from tests.unit.daemon_rig import DaemonRig


async def test_a_run_that_was_edited_while_it_was_open_is_not_good(rig: DaemonRig) -> None:
    rig.contact.may_end.clear()
    seq = await rig.started()
    await rig.contact.reached.wait()
    with closing(sqlite3.connect(rig.store_folder / "store.sqlite")) as editor:
        assert editor.execute("UPDATE poses SET residual_um = 0.1").rowcount
        editor.commit()
    rig.contact.may_end.set()
    await rig.to(State.STOPPED)
    head = (await rig.record()).head
    assert (head.result, head.fault_number) == ("bad", 827)
    assert rig.port.ended[seq] is Result.STOPPED
    assert rig.unit.parts == 0
    assert [one.number for one in await rig.archive.do(RunStore.active_alarms)] == [827]
    altered = "what was written of run 1 was changed after it was sealed"
    assert altered in await rig.archive.do(RunStore.verify)


async def test_a_head_that_cannot_be_read_for_the_journal_spoils_no_part(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    def unreadable(_store: RunStore) -> Never:
        raise StoreUnavailable("disk I/O error")

    monkeypatch.setattr(RunStore, "ledger_head", unreadable)
    seq = await rig.started()
    await rig.to(State.COMPLETED)
    assert (await rig.record()).head.result == "good"
    assert rig.port.ended[seq] is Result.GOOD
    assert rig.unit.parts == 1
