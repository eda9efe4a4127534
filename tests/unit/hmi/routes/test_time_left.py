"""What is left of the run that is open, of the records alone."""

import json
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from cellctl.hmi.answers.time_left import NOTHING
from cellctl.records.entries import DRY_RUN
from cellctl.records.store import RunStore
from tests.unit.hmi.in_process import Api
from tests.unit.records.conftest import start

STEPS = ((10, "measure"), (50, "mate"))
OPEN = 3
"""Number of the run of the store that has not ended."""


def run_of(
    store: RunStore, number: int, result: str = "", steps: Sequence[tuple[int, str]] = STEPS
) -> int:
    """Have a run go through the steps, and end if there is a result."""
    for step, label in steps:
        store.begin_phase(number, step, label)
    if result:
        store.close_run(number, result)
    return number


async def told(api: Api, number: int) -> dict[str, Any]:
    reply = await api.get(f"runs/{number}/time-left")
    assert reply.status == 200
    found: dict[str, Any] = json.loads(reply.body)
    return found


async def test_only_good_runs_of_the_recipe_say_what_is_usual(api: Api, store: Path) -> None:
    with closing(RunStore(store)) as records:
        run_of(records, OPEN)
        assert await told(api, OPEN) == NOTHING.model_dump() | {"by_runs": 0}
        records.close_run(OPEN, "good")
        run_of(records, start(records, "DECK-3"), "aborted")
        number = run_of(records, start(records, "DECK-4"))
        found = await told(api, number)
        assert (found["number"], found["step"], found["of"]) == (50, 2, 2)
        assert found["by_runs"] == 3, "those without steps are good runs, too"
        assert 0.0 <= found["left_s"] < 60.0
        records.close_run(number, "good")
        assert await told(api, number) == NOTHING.model_dump(), "it has ended"


async def test_a_dry_run_is_held_against_dry_runs_that_came_to_their_end(
    api: Api, store: Path
) -> None:
    with closing(RunStore(store)) as records:

        def dry(serial: str, result: str = "") -> int:
            return run_of(records, start(records, serial, mode=DRY_RUN), result, STEPS[:1])

        run_of(records, OPEN, "good")
        first = dry("DECK-3")
        assert await told(api, first) == NOTHING.model_dump(), "whole runs say nothing of it"
        records.close_run(first, "bad")
        dry("DECK-4", "aborted")
        found = await told(api, dry("DECK-5"))
        assert (found["step"], found["of"], found["by_runs"]) == (1, 1, 1)
        # Nor does it say anything of a whole one.
        records.close_run(first + 2, "bad")
        whole = run_of(records, start(records, "DECK-6"))
        assert (await told(api, whole))["of"] == len(STEPS)


@pytest.mark.parametrize("number", [0, 99])
async def test_a_run_that_there_is_not_has_no_time_left(api: Api, number: int) -> None:
    assert (await api.get(f"runs/{number}/time-left")).status == 404


async def test_records_are_read_again_only_when_there_is_another_good_run(
    api: Api, store: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with closing(RunStore(store)) as records:
        run_of(records, OPEN, "good")
        first = run_of(records, start(records, "DECK-3"))
    read: list[int] = []
    whole = RunStore.run

    def counted(self: RunStore, number: int) -> Any:
        read.append(number)
        return whole(self, number)

    monkeypatch.setattr(RunStore, "run", counted)
    await told(api, first)
    assert read == [first, 3, 2, 1]
    await told(api, first)
    assert read == [first, 3, 2, 1, first]
