"""Recall both ways: the parts behind a calibration, and the calibrations behind a part."""

import sqlite3
from contextlib import closing
from pathlib import Path

from cellctl.records.database.schema_version import FILE
from tests.unit.hmi.in_process import Api
from tests.unit.hmi.routes.conftest import NEW, OLD


async def test_the_parts_that_a_calibration_has_touched(api: Api) -> None:
    told = (await api.get(f"recall/calibrations/{NEW.id}")).json
    assert [run["number"] for run in told["runs"]] == [3, 2]
    assert told["serials"] == ["DECK-2", "FRAME-1"]
    assert told["runs"][1]["ended_as"] == "good"
    assert told["runs"][0]["ended_as"] == "open"
    assert (told["calibration"]["kind"], told["more"]) == ("head_1", False)
    first = (await api.get(f"recall/calibrations/{NEW.id}?limit=1")).json
    assert ([run["number"] for run in first["runs"]], first["more"]) == ([3], True)
    rest = (await api.get(f"recall/calibrations/{NEW.id}?limit=1&before=3")).json
    assert ([run["number"] for run in rest["runs"]], rest["more"]) == ([2], False)


async def test_a_stretch_of_time_without_runs_is_no_error_where_the_calibration_is_known(
    api: Api,
) -> None:
    told = (await api.get(f"recall/calibrations/{OLD.id}?until=2000-01-01T00:00:00Z")).json
    assert (told["runs"], told["serials"]) == ([], [])
    assert told["calibration"]["invalidated_reason"] == "the board was bent"
    unknown = await api.get("recall/calibrations/none")
    assert (unknown.status, unknown.json["type"]) == (404, "urn:cellctl:calibration-unknown")


async def test_everything_behind_a_part_names_the_part_it_was_joined_to(api: Api) -> None:
    told = (await api.get("recall/serials/DECK-1")).json
    joined, own = told["runs"]
    assert (joined["serial"], joined["joined_to"]) == ("FRAME-1", "DECK-1")
    assert (own["serial"], own["joined_to"], own["as_sealed"]) == ("DECK-1", "", True)
    (used,) = own["calibrations"]
    assert (used["name"], used["id"]) == ("head_1", OLD.id)
    assert used["kept"]["invalidated_reason"] == "the board was bent", "as it is known today"
    open_run = (await api.get("recall/serials/DECK-2")).json["runs"][0]
    assert (open_run["as_sealed"], open_run["ended"]) == (None, None)
    beginning = await api.get("recall/serials/DECK")
    assert (beginning.status, beginning.json["type"]) == (404, "urn:cellctl:serial-unknown")


async def test_a_run_that_somebody_has_changed_is_not_as_it_was_sealed(
    api: Api, store: Path
) -> None:
    assert (await api.get("runs/1")).json["as_sealed"] is True
    with closing(sqlite3.connect(store / FILE)) as database, database:
        database.execute("UPDATE runs SET operator = 'somebody else' WHERE number = 1")
    assert (await api.get("runs/1")).json["as_sealed"] is False
    (*_, own) = (await api.get("recall/serials/DECK-1")).json["runs"]
    assert own["as_sealed"] is False
    with closing(sqlite3.connect(store / FILE)) as database, database:
        database.execute("DELETE FROM ledger WHERE kind = 'run' AND subject = 2")
    assert (await api.get("runs/2")).json["as_sealed"] is False, "its seal is gone"
    assert (await api.get("runs/3")).json["as_sealed"] is None, "an open run has no seal yet"
