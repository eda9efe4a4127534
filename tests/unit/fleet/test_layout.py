"""Who may do what at the fleet database, and how older tables come to today's form."""

import pytest
from sqlalchemy import text
from sqlalchemy.exc import DBAPIError

from cellctl.errors.records.fleet import FleetDiffers, FleetRefused
from cellctl.fleet import layout, recall
from cellctl.fleet.address import PASSWORD as PASSWORD_VARIABLE
from cellctl.fleet.address import address
from cellctl.fleet.database import FleetDatabase
from tests.rigs import postgres
from tests.rigs.postgres import PASSWORD, PostgresServer
from tests.unit.fleet.conftest import NORTH, QUICK, SOUTH, Fleet, deliver_all
from tests.unit.fleet.test_delivery import assert_whole, everything


def refused(fleet: Fleet, user: str, statement: str) -> str:
    """What the server answers."""
    engine = fleet.server.engine(user, fleet.database)
    try:
        with engine.connect() as connection, pytest.raises(DBAPIError) as error:
            connection.execute(text(statement))
        return str(error.value.orig)
    finally:
        engine.dispose()


@pytest.mark.parametrize(
    "statement",
    [
        "DELETE FROM {north}.runs",
        "TRUNCATE {north}.ledger CASCADE",
        "UPDATE {north}.runs SET serial = 'X'",
        "UPDATE {north}.figures SET value = 0",
        "UPDATE {north}.ledger SET hash = repeat('0', 64)",
        "UPDATE {north}.audit SET actor = 'X'",
        "SELECT * FROM {north}.figures",
        "SELECT * FROM {south}.ledger",
        "INSERT INTO {south}.audit VALUES (1, now(), 'X', 'x', '{{}}')",
        "DROP TABLE {north}.runs CASCADE",
        "UPDATE fleet.cells SET place = 'x'",
    ],
)
def test_a_cell_may_not(fleet: Fleet, statement: str) -> None:
    filled = statement.format(north=fleet.places[NORTH], south=fleet.places[SOUTH])
    said = refused(fleet, "forward_north", filled)
    assert "permission denied" in said or "must be owner" in said


def test_a_database_that_names_no_encoding_is_one_of_a_fleet_too(
    server: PostgresServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A server that was set up in the locale C makes such ones."""
    monkeypatch.setenv(PASSWORD_VARIABLE, PASSWORD)
    server.execute("CREATE DATABASE plain TEMPLATE template0 ENCODING 'SQL_ASCII'")
    owner = FleetDatabase(address(server.url(postgres.OWNER, "plain")), QUICK)
    layout.create(owner)
    layout.add_cell(owner, SOUTH, "forward_south")
    assert [cell.name for cell in recall.cells(owner)] == [SOUTH]
    owner.close()


def test_what_is_recorded_stays_whoever_asks(fleet: Fleet) -> None:
    everything(fleet.store(NORTH))
    deliver_all(fleet.delivery(NORTH))
    for statement in (
        "UPDATE {north}.runs SET result = 'good' WHERE ended IS NOT NULL",
        "UPDATE {north}.runs SET ended = NULL WHERE ended IS NOT NULL",
        "UPDATE {north}.alarms SET acknowledged_by = 'X' WHERE acknowledged IS NOT NULL",
        "UPDATE {north}.ledger_head SET length = 1",
    ):
        filled = statement.format(north=fleet.places[NORTH])
        said = refused(fleet, "forward_north", filled)
        assert "keeps what is recorded" in said, statement


def test_readers_read_every_cell_and_change_nothing(fleet: Fleet) -> None:
    store = fleet.store(NORTH)
    everything(store)
    deliver_all(fleet.delivery(NORTH))
    said = refused(fleet, "quality", f"SELECT * FROM {fleet.places[NORTH]}.runs")
    assert "permission denied" in said
    fleet.execute(f"GRANT {layout.READERS} TO quality")
    reader = fleet.connected("quality")
    assert [cell.name for cell in recall.cells(reader)] == [NORTH, SOUTH]
    assert recall.problems(reader, NORTH, store.ledger_head()) == []
    said = refused(fleet, "quality", f"UPDATE {fleet.places[NORTH]}.runs SET ended = NULL")
    assert "permission denied" in said


def test_making_it_again_is_no_change(fleet: Fleet) -> None:
    layout.create(fleet.owner)
    assert layout.add_cell(fleet.owner, NORTH, "forward_north") == fleet.places[NORTH]
    assert layout.migrate(fleet.owner) == []


def test_places_are_readable_and_different(fleet: Fleet) -> None:
    assert fleet.places == {NORTH: "cell_north_cell", SOUTH: "cell_s_d_2"}
    assert layout.add_cell(fleet.owner, "North-Cell", "forward_south") == "cell_north_cell_2"
    with pytest.raises(FleetRefused, match="no role"):
        layout.add_cell(fleet.owner, "another", "nobody")
    assert [cell.name for cell in recall.cells(fleet.owner)] == ["North-Cell", NORTH, SOUTH]


def test_tables_of_an_earlier_version_are_migrated_with_what_is_in_them(fleet: Fleet) -> None:
    """Schema 2 had no head of the ledger, no number of a gauge, no names in the ledger."""
    store = fleet.store(NORTH)
    everything(store)
    delivery = fleet.delivery(NORTH)
    delivery.deliver(3)  # calibrations and a run that has begun
    place = fleet.places[NORTH]
    fleet.execute(f"DROP TABLE {fleet.places[SOUTH]}.ledger_head")
    fleet.execute(f"ALTER TABLE {fleet.places[SOUTH]}.gauges DROP COLUMN gauge_id")
    fleet.execute(f"ALTER TABLE {place}.gauges DROP COLUMN gauge_id")
    fleet.execute("UPDATE fleet.cells SET record_schema = 2")
    assert layout.migrate(fleet.owner) == [NORTH, SOUTH]
    assert recall.problems(fleet.owner, NORTH) == []
    deliver_all(delivery)
    assert_whole(fleet, NORTH, store)
    south = fleet.store(SOUTH)
    everything(south)
    deliver_all(fleet.delivery(SOUTH))
    assert_whole(fleet, SOUTH, south)


def test_tables_of_a_later_version_are_not_touched(fleet: Fleet) -> None:
    fleet.execute("UPDATE fleet.cells SET record_schema = 99")
    with pytest.raises(FleetDiffers, match="later"):
        layout.migrate(fleet.owner)


@pytest.mark.parametrize(
    ("statement", "problem"),
    [
        ("UPDATE {place}.figures SET value = 1 WHERE key = 'peak_force'", "run 1 was changed"),
        *(
            pytest.param(*one, marks=pytest.mark.figures)
            for one in (
                ("DELETE FROM {place}.ledger WHERE number = 3", "does not follow"),
                (
                    "INSERT INTO {place}.audit VALUES (99, now(), 'X', 'x', '{{}}')",
                    "audit 99 is not",
                ),
                ("DELETE FROM {place}.passes WHERE number = 2", "run 1 was changed"),
                ("UPDATE {place}.audit SET actor = 'X'", "audit 1 was changed"),
                ("UPDATE {place}.gauges SET diameter_mm = 6 WHERE id = 1", "gauge 1 was changed"),
                ("UPDATE {place}.persistent_values SET value = 1", "value line_seq was changed"),
                ("DELETE FROM {place}.ledger WHERE number > 9", "ledger's head"),
            )
        ),
    ],
)
def test_a_change_at_the_centre_is_found(fleet: Fleet, statement: str, problem: str) -> None:
    everything(fleet.store(NORTH))
    deliver_all(fleet.delivery(NORTH))
    assert recall.problems(fleet.owner, NORTH) == []
    fleet.execute(statement.format(place=fleet.places[NORTH]))
    found = recall.problems(fleet.owner, NORTH)
    assert any(problem in text for text in found), found
