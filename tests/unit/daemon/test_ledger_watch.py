"""A ledger that is cut, or made anew, under a running daemon."""

import re
import sqlite3
from contextlib import closing
from typing import Any

import pytest

from cellctl.daemon.ledger_watch import LedgerWatch
from cellctl.packml.state import State
from cellctl.records.seals import LedgerHead
from cellctl.records.store import RunStore
from tests.unit.daemon_rig import DaemonRig

CUT = (
    "DELETE FROM figures",
    "DELETE FROM ledger WHERE number > 3",
    "UPDATE ledger_head SET (length, hash) ="
    " (SELECT number, hash FROM ledger ORDER BY number DESC LIMIT 1)",
)
"""The newest entries are gone and the head says so; the chain itself is whole."""


def execute(rig: DaemonRig, *statements: str) -> None:
    with closing(sqlite3.connect(rig.store_folder / "store.sqlite")) as connection:
        for statement in statements:
            connection.execute(statement)
        connection.commit()


async def made(rig: DaemonRig, serial: str = "SAT-7") -> None:
    await rig.started(serial=serial)
    await rig.to(State.COMPLETED)


async def test_a_ledger_that_was_cut_is_a_fault_once(rig: DaemonRig) -> None:
    await made(rig)
    watch = LedgerWatch(rig.archive, rig.unit)
    await watch.look()
    execute(rig, *CUT)
    await watch.look()
    await rig.to(State.STOPPED)
    await watch.look()
    await rig.unit.background.drain()
    assert [one.number for one in await rig.archive.do(RunStore.active_alarms)] == [827]


async def test_a_ledger_that_grows_is_none(rig: DaemonRig) -> None:
    watch = LedgerWatch(rig.archive, rig.unit)
    await watch.look()
    await made(rig)
    await watch.look()
    await made(rig, "SAT-8")
    await watch.look()
    assert not rig.shown().alarms


async def test_a_line_of_the_journal_proves_that_the_newest_run_was_cut_off(
    rig: DaemonRig, capsys: pytest.CaptureFixture[Any]
) -> None:
    await made(rig)
    heads = re.findall(r"run closed.*ledger_head=(\d+):(\w+)", capsys.readouterr().out)
    (printed,) = [LedgerHead(int(length), value) for length, value in heads]
    assert await rig.archive.do(RunStore.verify, printed) == []
    execute(rig, *CUT)
    found = await rig.archive.do(RunStore.verify, printed)
    assert f"the head given says {printed.length} entries, the ledger ends at 3" in found
