"""Procedures by the API: what they need, what they renew, and where they stand."""

from typing import Any

import pytest

from tests.unit.hmi.in_process import Api

UNDER_WAY = {"number": 0, "label": "", "text": "head 1: view 3 of 20"}


def running(state: str, recipe: int = 101, mode: str = "MAINTENANCE") -> dict[str, Any]:
    run = {"number": 9, "serial": "", "recipe": recipe, "result": "good", "good_parts": 0}
    return {"state": state, "mode": mode, "run": run, "step": UNDER_WAY}


async def test_a_procedure_says_what_it_needs_and_renews(api: Api) -> None:
    guided, plain = (await api.get("procedures")).json["procedures"]
    assert guided["set_up"] == ["The calibration board lies under the head.", "The light is on."]
    assert (guided["moves"], guided["then"]) == (["Nothing else moves."], ["Take the board away."])
    (renewed,) = guided["renews"]
    assert (renewed["kind"], renewed["problem"]) == ("head", "")
    assert renewed["valid_until"] == "2036-01-02T03:04:05Z"
    assert (plain["number"], plain["set_up"], plain["renews"]) == (900, [], [])
    assert (await api.get("procedures/900")).json == plain
    unknown = await api.get("procedures/7")
    assert (unknown.status, unknown.json["type"]) == (404, "urn:cellctl:procedure-unknown")


async def test_one_that_was_never_made_has_no_date(api: Api) -> None:
    await api.describe(calibrations=[])
    (renewed,) = (await api.get("procedures/101")).json["renews"]
    assert (renewed["made"], renewed["valid_until"]) == (None, None)


@pytest.mark.parametrize(
    ("said", "stage", "run"),
    [
        (running("EXECUTE"), "under way", 9),
        (running("HELD"), "under way", 9),
        (running("COMPLETED"), "ended", 9),
        (running("ABORTED"), "ended", 9),
        (running("IDLE"), "at rest", None),
        (running("EXECUTE", recipe=102), "at rest", None),
        # The recipe of a part may have the number of a procedure.
        (running("EXECUTE", mode="PRODUCTION"), "at rest", None),
    ],
)
async def test_where_a_procedure_stands(
    api: Api, said: dict[str, Any], stage: str, run: int | None
) -> None:
    await api.hear(**said)
    told = (await api.get("procedures/101")).json
    assert (told["stage"], told["run"]) == (stage, run)
    assert told["progress"] == ("head 1: view 3 of 20" if stage == "under way" else "")
    assert told["result"] == ("good" if stage == "ended" else "")
