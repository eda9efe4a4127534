"""What the cell does not say is shown as a dash, whatever it is and whichever screen shows it."""

import copy
import json
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import expect

from tests.rigs.sweeps import sweep
from tests.unit.hmi.page.screen import Screen
from tests.unit.hmi.scripted_daemon import PaperDaemon, alarm, snapshot

SCREENS = ("run", "alarms", "history", "calibration", "maintenance", "maintenance/101", "line",
           "health")  # fmt: skip
NEEDED = frozenset({("kind",), ("mono_s",)})
"""What makes a line a snapshot with an age; without an age it is old, which other tests look at."""
NO_VALUE = ("undefined", "NaN", "[object", "Invalid Date", "null", "Infinity")
"""What scripts make of a value that is not there."""

TOLD = """([kind, variants, words]) => {
    const wrong = [];
    const complain = (event) => { wrong.push([name, event.message]); event.preventDefault(); };
    let name = "";
    addEventListener("error", complain);
    const tell = (data) => window.streams.at(-1).dispatchEvent(new MessageEvent(kind, { data }));
    for (const [variant, data] of variants) {
        name = variant;
        tell(data);
        // A script keeps there what it has drawn; nobody reads it.
        const shown = document.body.outerHTML.replace(/ data-of="[^"]*"/g, "");
        for (const word of words) if (shown.includes(word)) wrong.push([name, word]);
    }
    removeEventListener("error", complain);
    return wrong;
}"""


def full_snapshot() -> dict[str, Any]:
    """A cell in the middle of a run, of which it says everything."""
    force_limit = alarm(512, "force limit") | {"reaction": "abort"}
    said = snapshot(
        mono_s=1e9,
        state="EXECUTE",
        state_requested="COMPLETING",
        step={"number": 50, "label": "mate", "text": "head_1: view 2 of 3"},
        run={"number": 17, "serial": "SAT-1", "recipe": 101, "result": "none", "good_parts": 4},
        faults=[force_limit],
        alarms=[force_limit, alarm(207, "too old", "warn") | {"times": 3}],
        last_command={"who": "page:anna@panel-1", "command": "hold", "time": "2026-01-02T03:04Z"},
    )
    said["pass"] = 2
    said["errors"] = [one | {"value": 0.02, "limit": 0.05} for one in said["errors"]]
    said["permitted"] = {name: said["permitted"][name] for name in ("start", "hold", "mode")}
    said["forces"][0] |= {"presses_n": 12.0, "trip": "a trip", "touch": "a touch"}
    return said


def without_each(said: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """The message once for each of its fields: without it, and with nothing in it."""
    for path in _paths(said):
        if path in NEEDED:
            continue
        for how in ("absent", "null"):
            changed = copy.deepcopy(said)
            place = changed
            for key in path[:-1]:
                place = place[key]
            if how == "null":
                place[path[-1]] = None
            elif isinstance(path[-1], str):
                del place[path[-1]]
            yield f"{how} {'.'.join(map(str, path))}", json.dumps(changed)


def _paths(said: Any, before: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    # Of a list the first entry stands for all.
    named = said.items() if isinstance(said, dict) else enumerate(said[:1])
    for key, value in named:
        # An entry of a list that is nothing is no message of any daemon.
        if isinstance(key, str):
            yield (*before, key)
        if isinstance(value, dict | list):
            yield from _paths(value, (*before, key))


@pytest.fixture
def listening(screen: Screen) -> Screen:
    screen.sign_in("boris")
    screen.listen()
    return screen


@pytest.mark.parametrize("language", sweep(("en", "zh"), ("en",)))
def test_no_field_that_is_missing_stops_a_screen(
    listening: Screen, paper: PaperDaemon, language: str
) -> None:
    tab, wrong = listening.tab, []
    if language == "zh":
        tab.click("#language")
    messages = {
        "snapshot": list(without_each(full_snapshot())),
        "description": list(without_each({"kind": "description", **paper.description})),
    }
    for name in SCREENS:
        tab.goto(f"{listening.url}#{name}")
        expect(tab.locator("main > *").first).to_be_visible()
        for kind, variants in messages.items():
            found = tab.evaluate(TOLD, [kind, variants, NO_VALUE])
            wrong += [(name, *one) for one in found]
    assert wrong == [], wrong
