"""Calibrations of the records: those that are replaced or void are told as such."""

import asyncio
from pathlib import Path

from tests.unit.hmi.in_process import Api
from tests.unit.hmi.routes.conftest import NEW, OLD


async def test_the_newest_first_with_its_figures(api: Api) -> None:
    listed = (await api.get("calibrations")).json["calibrations"]
    assert [one["id"] for one in listed] == [NEW.id, OLD.id]
    assert [one["checks"][0]["value"] for one in listed] == [0.18, 0.12], "how it moves"
    assert listed[0]["made"] == "2026-01-03T03:04:05.678+00:00"
    assert (await api.get("calibrations?kind=payload")).json["calibrations"] == []
    assert len((await api.get("calibrations?kind=head_1&limit=1")).json["calibrations"]) == 1


async def test_which_of_them_the_cell_has_now(api: Api) -> None:
    api.parts.hub.description = {}
    assert (await api.get(f"calibrations/{NEW.id}")).json["in_use"] is None, "nobody has said"
    entry = {"kind": "head_1", "made": "", "valid_until": "", "problem": "expired"}
    await api.describe(calibrations=[entry | {"identity": NEW.id}])
    new, old = (await api.get("calibrations")).json["calibrations"]
    assert (new["in_use"], new["problem"]) == (True, "expired")
    assert (old["in_use"], old["problem"]) == (False, None)


async def test_one_with_its_content(api: Api) -> None:
    told = (await api.get(f"calibrations/{OLD.id}")).json
    assert told["record"]["method"] == "test"
    assert (told["serial_number"], told["software"]) == ("H-1", "cellctl 1")
    assert told["invalidated"] is not None
    unknown = await api.get("calibrations/none")
    assert (unknown.status, unknown.json["type"]) == (404, "urn:cellctl:calibration-unknown")


async def test_a_store_that_is_away_is_a_fault_with_its_remedy(api: Api, store: Path) -> None:
    await asyncio.to_thread(store.rename, store.with_name("elsewhere"))
    reply = await api.get("calibrations")
    assert (reply.status, reply.json["fault"]) == (503, 801)
    assert reply.json["remedy"]
    assert not await asyncio.to_thread(store.exists), "no reader makes an empty store in its place"
