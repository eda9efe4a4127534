"""The server or the forwarder dies at the worst moment; nothing is lost, nothing comes twice."""

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import text

from cellctl.errors.records.fleet import FleetUnreachable
from cellctl.fleet import delivery as delivery_module
from cellctl.fleet.address import PASSWORD as PASSWORD_VARIABLE
from cellctl.fleet.address import address
from cellctl.fleet.cell_records import CellRecords
from cellctl.fleet.database import FleetDatabase, FleetTimeLimits
from cellctl.fleet.delivery import Delivery
from cellctl.fleet.forwarder import Forwarder, ForwarderPace
from cellctl.records import RunStore
from cellctl.records.files.delivery_file import DeliveryState
from tests.rigs.postgres import PASSWORD
from tests.unit.fleet.conftest import NORTH, Fleet, deliver_all
from tests.unit.fleet.test_delivery import assert_whole, everything

ROOT = Path(__file__).parents[3]
SLOW = FleetTimeLimits(connect_s=5, statement_s=0.3, silence_s=5.0)


def filled(fleet: Fleet) -> RunStore:
    store = fleet.store(NORTH)
    everything(store)
    return store


def after_applying(monkeypatch: pytest.MonkeyPatch, act: Callable[[], None]) -> None:
    """``act`` happens when all rows of a batch are sent and nothing is committed."""
    apply = delivery_module._apply

    def applied(*arguments: Any) -> None:
        apply(*arguments)
        act()

    monkeypatch.setattr(delivery_module, "_apply", applied)


def test_a_server_that_dies_in_the_middle_of_a_transaction(
    fleet: Fleet, monkeypatch: pytest.MonkeyPatch
) -> None:
    store, delivery = filled(fleet), fleet.delivery(NORTH)
    delivery.deliver(3)
    after_applying(monkeypatch, fleet.server.kill)
    with pytest.raises(FleetUnreachable):
        delivery.deliver(3)
    monkeypatch.undo()
    monkeypatch.setenv(PASSWORD_VARIABLE, PASSWORD)
    with pytest.raises(FleetUnreachable):
        delivery.deliver(3)
    # The cell goes on meanwhile.
    store.audit("OP-7", "note", {"while": "the server is away"})
    fleet.server.start()
    deliver_all(delivery, 3)
    assert_whole(fleet, NORTH, store)


def test_a_connection_that_is_cut(fleet: Fleet, monkeypatch: pytest.MonkeyPatch) -> None:
    store, delivery = filled(fleet), fleet.delivery(NORTH)

    def cut() -> None:
        fleet.execute(
            "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE usename = 'forward_north'"
        )

    after_applying(monkeypatch, cut)
    with pytest.raises(FleetUnreachable):
        delivery.deliver()
    monkeypatch.undo()
    assert fleet.owner is not None
    deliver_all(delivery)
    assert_whole(fleet, NORTH, store)


def test_an_answer_that_is_lost_after_the_commit(
    fleet: Fleet, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The batch is there, and its sender does not know: he asks before he sends it again."""
    store, delivery = filled(fleet), fleet.delivery(NORTH)
    transaction = FleetDatabase.transaction
    applied: list[bool] = []

    @contextmanager
    def deaf(self: FleetDatabase, place: str | None = None) -> Iterator[Any]:
        with transaction(self, place) as connection:
            yield connection
        if applied:
            raise FleetUnreachable("the answer was lost")

    apply = delivery_module._apply

    def noted(connection: Any, *arguments: Any) -> None:
        applied.append(True)
        apply(connection, *arguments)

    monkeypatch.setattr(FleetDatabase, "transaction", deaf)
    monkeypatch.setattr(delivery_module, "_apply", noted)
    with pytest.raises(FleetUnreachable, match="lost"):
        delivery.deliver(4)
    monkeypatch.setattr(FleetDatabase, "transaction", transaction)
    deliver_all(delivery, 4)
    assert_whole(fleet, NORTH, store)


def test_a_server_that_is_too_slow(fleet: Fleet) -> None:
    store = filled(fleet)
    place = fleet.places[NORTH]
    records = CellRecords(fleet.folder(NORTH))
    user = fleet.connected("forward_north", SLOW)
    engine = fleet.server.engine(database=fleet.database)
    with engine.connect() as blocking:
        blocking.execute(text("BEGIN"))
        blocking.execute(text(f"LOCK TABLE {place}.figures IN ACCESS EXCLUSIVE MODE"))
        with pytest.raises(FleetUnreachable, match="timeout"):
            deliver_all(Delivery(NORTH, records, user, "test"))
        blocking.execute(text("ROLLBACK"))
    engine.dispose()
    records.close()
    deliver_all(fleet.delivery(NORTH))
    assert_whole(fleet, NORTH, store)


def test_a_server_that_hangs_and_goes_on(fleet: Fleet) -> None:
    """Its sender waits with it, and the cell's own store does not."""
    store, delivery = filled(fleet), fleet.delivery(NORTH)
    delivery.deliver(2)
    fleet.server.pause(paused=True)
    worker = threading.Thread(target=deliver_all, args=(delivery,))
    worker.start()
    try:
        store.audit("OP-7", "note", {"while": "the server hangs"})
        worker.join(0.3)
        assert worker.is_alive()
    finally:
        fleet.server.pause(paused=False)
        worker.join(60)
    assert not worker.is_alive()
    deliver_all(delivery)
    assert_whole(fleet, NORTH, store)


def test_a_server_without_room_is_asked_again_later(fleet: Fleet) -> None:
    """A full disk is told to the client like this; it loses nothing that was committed."""
    from psycopg.errors import DiskFull
    from sqlalchemy.exc import OperationalError

    from cellctl.fleet.database import fault_of

    fault = fault_of(OperationalError("INSERT", {}, DiskFull("could not extend file")))
    assert isinstance(fault, FleetUnreachable)
    assert "could not extend file" in fault.detail


KILLED = """
import os, signal, sys
from pathlib import Path
from cellctl.fleet import delivery as module
from cellctl.fleet.address import address
from cellctl.fleet.cell_records import CellRecords
from cellctl.fleet.database import FleetDatabase
where, after, url, folder, cell = sys.argv[1:]
left = [int(after)]
def counted(function):
    def call(*arguments, **named):
        left[0] -= 1
        if left[0] < 0:
            os.kill(os.getpid(), signal.SIGKILL)
        return function(*arguments, **named)
    return call
setattr(module, where, counted(getattr(module, where)))
delivery = module.Delivery(cell, CellRecords(Path(folder)), FleetDatabase(address(url)), "test")
while delivery.deliver(3):
    pass
"""


@pytest.mark.parametrize(
    ("where", "after"),
    [
        ("_insert", 5),
        *(
            pytest.param(where, after, marks=pytest.mark.figures)
            for where, after in (("_fill", 0), ("_upsert", 4), ("_delivered", 3))
        ),
        *(
            pytest.param(where, after, marks=pytest.mark.long)
            for where, after in
            (("_insert", 0), ("_insert", 12), ("_upsert", 0), ("_apply", 2))
        ),
    ],
)  # fmt: skip
def test_a_forwarder_that_is_killed(fleet: Fleet, where: str, after: int) -> None:
    store = filled(fleet)
    url = fleet.server.url("forward_north", fleet.database)
    command = [
        sys.executable,
        "-c",
        KILLED,
        where,
        str(after),
        url,
        str(fleet.folder(NORTH)),
        NORTH,
    ]
    ended = subprocess.run(
        command, check=False, cwd=ROOT, env=os.environ | {"PYTHONPATH": str(ROOT)}
    )
    assert ended.returncode == -signal.SIGKILL
    deliver_all(fleet.delivery(NORTH), 3)
    assert_whole(fleet, NORTH, store)


def test_the_forwarder_says_an_outage_once_and_waits_longer_and_longer(
    fleet: Fleet, caplog: pytest.LogCaptureFixture
) -> None:
    store = filled(fleet)
    fleet.server.stop()
    waits: list[float] = []

    def wait(seconds: float) -> None:
        waits.append(seconds)
        if len(waits) == 4:
            fleet.server.start()

    told: list[DeliveryState] = []
    pace = ForwarderPace(2.0, 1.0, 3.0)
    forwarder = Forwarder(fleet.delivery(NORTH), pace, wait, told.append)
    forwarder.run(until=lambda: len(waits) >= 6)
    assert waits == [1.0, 2.0, 3.0, 3.0, 2.0, 2.0]
    away, back = told[:4], told[4:]
    assert all(state.fault.startswith("F831") and state.remedy for state in away)
    assert {state.still_to_come for state in away} == {None}
    assert [(state.fault, state.still_to_come) for state in back] == [("", 0), ("", 0)]
    assert back[-1].delivered is not None
    assert_whole(fleet, NORTH, store)


def test_a_wrong_password_is_told_and_never_printed(
    fleet: Fleet, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(PASSWORD_VARIABLE, "not this one")
    found = address(fleet.server.url("forward_north", fleet.database))
    assert "not this one" not in f"{found} {found!r}"
    database = FleetDatabase(found)
    with pytest.raises(FleetUnreachable, match="password authentication failed") as fault:
        Delivery(NORTH, CellRecords(fleet.folder(NORTH)), database, "test").deliver()
    assert "not this one" not in str(fault.value)
    database.close()
