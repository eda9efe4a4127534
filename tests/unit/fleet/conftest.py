"""A server for all tests of a worker, a fleet of two cells and their stores for each."""

import itertools
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from cellctl.fleet import layout
from cellctl.fleet.address import PASSWORD as PASSWORD_VARIABLE
from cellctl.fleet.address import address
from cellctl.fleet.cell_records import CellRecords
from cellctl.fleet.database import FleetDatabase, FleetTimeLimits
from cellctl.fleet.delivery import Delivery
from cellctl.records import RunStore
from tests.rigs import postgres
from tests.rigs.postgres import PASSWORD, PostgresServer

QUICK = FleetTimeLimits(connect_s=5, statement_s=5.0, silence_s=5.0)
"""No test waits as long as a cell may."""
NORTH, SOUTH = "north cell", "süd: 2"
FORWARDERS = {NORTH: "forward_north", SOUTH: "forward_south"}
_MODEL = "fleet_model"
_numbers = itertools.count()


@pytest.fixture(scope="session")
def server() -> Iterator[PostgresServer]:
    if reason := postgres.missing():
        pytest.skip(reason)
    # Not below a folder of pytest, into which the server's user may not look.
    place = postgres.quick_place()
    with tempfile.TemporaryDirectory(prefix="cellctl-fleet-", dir=place) as name:
        Path(name).chmod(0o755)
        server = started(Path(name))
        yield server
        server.kill()  # in order it would first write down what is thrown away here


def started(folder: Path) -> PostgresServer:
    """A server with the roles of a fleet, and an empty fleet of which each test has a copy."""
    server = PostgresServer(folder)
    server.start()
    roles = (*FORWARDERS.values(), "quality")
    server.execute(*(f"CREATE ROLE {name} LOGIN PASSWORD '{PASSWORD}'" for name in roles))
    server.execute(f"CREATE DATABASE {_MODEL}")
    with pytest.MonkeyPatch.context() as environment:
        environment.setenv(PASSWORD_VARIABLE, PASSWORD)
        owner = FleetDatabase(address(server.url(postgres.OWNER, _MODEL)), QUICK)
        layout.create(owner)
        for name, forwarder in FORWARDERS.items():
            layout.add_cell(owner, name, forwarder)
        owner.close()
    return server


class Fleet:
    """A database with two cells, and whoever works with it."""

    def __init__(self, server: PostgresServer, folder: Path) -> None:
        self.server = server
        self.database = f"fleet_{next(_numbers)}"
        self._folder = folder
        self._open: list[FleetDatabase | CellRecords | RunStore] = []
        server.execute(f"CREATE DATABASE {self.database} TEMPLATE {_MODEL}")
        self.owner = self.connected(postgres.OWNER)
        self.places = {
            name: layout.add_cell(self.owner, name, role) for name, role in FORWARDERS.items()
        }

    def connected(self, user: str, limits: FleetTimeLimits = QUICK) -> FleetDatabase:
        found = FleetDatabase(address(self.server.url(user, self.database)), limits)
        self._open.append(found)
        return found

    def store(self, cell: str) -> RunStore:
        """The cell's own."""
        store = RunStore(self.folder(cell))
        self._open.append(store)
        return store

    def folder(self, cell: str) -> Path:
        return self._folder / self.places[cell]

    def delivery(self, cell: str, folder: Path | None = None) -> Delivery:
        records = CellRecords(folder or self.folder(cell))
        self._open.append(records)
        user = self.connected(FORWARDERS[cell])
        return Delivery(cell, records, user, "cellctl 0.1.0 (test)")

    def execute(self, statement: str) -> None:
        """Execute a statement as somebody who has every right."""
        self.server.execute(statement, database=self.database)

    def close(self) -> None:
        for one in self._open:
            one.close()


@pytest.fixture
def fleet(
    server: PostgresServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Fleet]:
    monkeypatch.setenv(PASSWORD_VARIABLE, PASSWORD)
    fleet = Fleet(server, tmp_path)
    yield fleet
    fleet.close()


def deliver_all(delivery: Delivery, limit: int = 200) -> int:
    """Deliver until nothing is left; how many batches it took."""
    for batches in itertools.count(1):
        if not delivery.deliver(limit):
            return batches
    raise AssertionError
