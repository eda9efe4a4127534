"""Each button in each state and mode, for each role and place: as the cell itself would answer."""

import json
from typing import Any, cast, get_args

import pytest

from cellctl.api.local_socket.messages import Role
from cellctl.api.local_socket.page_desk import ENDS_MOTION, not_theirs
from cellctl.command.permitted import permitted
from cellctl.hmi.answers.permissions import permissions, session_told
from cellctl.hmi.visitors.access import Visitor
from cellctl.hmi.words.page_words import page_words
from cellctl.packml.machine import PackMLMachine
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State
from cellctl.runtime.jobs.factory import JobFactory
from tests.rigs.sweeps import sweep
from tests.unit.hmi.page.screen import Screen
from tests.unit.hmi.scripted_daemon import PaperDaemon, snapshot

STATES = [state for state in State if state is not State.UNDEFINED]
MODES = [mode for mode in Mode if mode is not Mode.INVALID]
BUTTONS = {
    "run": ("start", "reset", "hold", "unhold", "clear", "stop", "abort"),
    "maintenance/101": ("procedure", "mode", "clear", "reset", "hold", "unhold", "stop", "abort"),
}
VISITORS = [(role, panel) for role in get_args(Role) for panel in ("", "panel-1")]
SAID = """([name, told]) => told.map((data) => {
    window.streams.at(-1).dispatchEvent(new MessageEvent("snapshot", { data }));
    return Object.fromEntries([...document.querySelectorAll("main [data-command]")].map((place) => [
        place.dataset.command,
        [place.querySelector("button").disabled, place.querySelector("small").textContent]]));
})"""


class StandingMachine(PackMLMachine):
    """In a state and mode that a test chooses."""

    def __init__(self, state: State, mode: Mode) -> None:
        super().__init__({})
        self._standing, self._mode = state, mode

    @property
    def state(self) -> State:
        return self._standing


class Jobs:
    """Production lacks a calibration; everything else may begin."""

    def refusal(self, mode: Mode) -> RejectCode:
        return RejectCode.CALIBRATION_INVALID if mode is Mode.PRODUCTION else RejectCode.NONE


def told(state: State, mode: Mode, *, line_alive: bool, mono_s: float) -> dict[str, Any]:
    """What the daemon pushes of a cell that stands so."""
    machine = StandingMachine(state, mode)
    codes = permitted(machine, cast(JobFactory, Jobs()), line_alive=line_alive)
    said = {name: {"code": int(code), "reason": code.text} for name, code in codes.items()}
    names = {"state": state.name, "state_requested": state.name, "mode": mode.name}
    return snapshot(**names, line_alive=line_alive, permitted=said, mono_s=mono_s)


@pytest.mark.parametrize(
    ("role", "panel"), sweep(VISITORS, (("operate", "panel-1"), ("maintain", "")))
)
def test_page_api_and_cell_say_the_same(
    screen: Screen, paper: PaperDaemon, role: Role, panel: str
) -> None:
    visitor = Visitor("anna", role, panel, "key")
    session = session_told(visitor, "en").model_dump()
    screen.tab.route("**/api/v1/session", lambda route: route.fulfill(json=session))
    screen.listen()
    words, wrong = page_words("en"), []
    # Old for no moment of the test: an age below nought is none.
    cells = [
        told(state, mode, line_alive=alive, mono_s=1e9)
        for state in STATES
        for mode in MODES
        for alive in (False, True)
    ]
    lines = [json.dumps(cell) for cell in cells]
    for name, commands in BUTTONS.items():
        screen.tab.evaluate("(name) => { location.hash = name; }", name)
        screen.tab.locator(f"main [data-command={commands[0]}]").wait_for()
        for box in screen.tab.locator("main [type=checkbox]").all():
            box.check()
        for cell, shown in zip(cells, screen.tab.evaluate(SAID, [name, lines]), strict=True):
            answers = permissions(visitor, cell["permitted"], "en")
            for command in commands:
                theirs = not_theirs(command, role, panel)
                said = 0 if command in ENDS_MOTION else cell["permitted"][command]["code"]
                code = theirs or RejectCode(said)
                disabled, reason = shown[command]
                at = (name, command, cell["state"], cell["mode"], cell["line_alive"], code.name)
                # The mode that a procedure needs is not set once more.
                set_already = (command, cell["mode"]) == ("mode", "MAINTENANCE")
                if disabled != (bool(code) or set_already):
                    wrong.append((*at, disabled))
                if code and not theirs and reason != words[f"reject_{int(code)}"]:
                    wrong.append((*at, reason))
                if command not in ENDS_MOTION and answers[command].code != code:
                    wrong.append((*at, answers[command]))
    assert wrong == [], wrong
