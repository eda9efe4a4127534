"""The tables against the standard, pair by pair, and the built machine against the tables."""

import itertools
from pathlib import Path

import pytest
from transitions import MachineError

from cellctl.packml.chart import StateChart
from cellctl.packml.command import COMMANDS, Command
from cellctl.packml.document import state_machine_document
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import STATES, State
from cellctl.packml.transition_tables import MODE_CHANGE_IN, ON_COMMAND, WHEN_DONE, requested
from cellctl.packml.validation import validate_command, validate_mode

# Written out by hand from the 2022 edition's defaults: per state, command number -> state number.
STANDARD = {
    1: {8: 8},
    2: {1: 15, 8: 8},
    3: {3: 7, 8: 8},
    4: {2: 3, 3: 7, 8: 8},
    5: {3: 7, 4: 10, 7: 14, 8: 8, 10: 16},
    6: {3: 7, 4: 10, 6: 13, 8: 8, 10: 16},
    7: {8: 8},
    8: {},
    9: {9: 1},
    10: {3: 7, 8: 8},
    11: {3: 7, 5: 12, 8: 8, 10: 16},
    12: {3: 7, 8: 8},
    13: {3: 7, 8: 8},
    14: {3: 7, 8: 8},
    15: {3: 7, 8: 8},
    16: {3: 7, 8: 8},
    17: {1: 15, 3: 7, 8: 8},
}
STATE_COMPLETE = {15: 4, 3: 6, 6: 16, 10: 11, 12: 6, 13: 5, 14: 6, 16: 17, 7: 2, 8: 9, 1: 2}
PAIRS = list(itertools.product(STATES, COMMANDS))


def test_there_are_170_pairs_of_which_39_lead_somewhere() -> None:
    assert len(PAIRS) == 170
    assert len(ON_COMMAND) == 39


@pytest.mark.parametrize("state", STATES, ids=lambda state: state.name)
def test_every_command_leads_where_the_standard_says(state: State) -> None:
    for command in COMMANDS:
        chart = StateChart(state)
        code = validate_command(state, Mode.PRODUCTION, command)
        if command in STANDARD[state]:
            assert chart.command(command) == STANDARD[state][command], command.name
            assert code is RejectCode.NONE, command.name
        else:
            with pytest.raises(MachineError):
                chart.command(command)
            assert chart.state is state, command.name
            assert code is RejectCode.COMMAND_NOT_ALLOWED, command.name


@pytest.mark.parametrize("state", STATES, ids=lambda state: state.name)
def test_state_complete_leads_where_the_standard_says(state: State) -> None:
    chart = StateChart(state)
    if state in STATE_COMPLETE:
        assert chart.complete() == STATE_COMPLETE[state]
    else:
        with pytest.raises(MachineError):
            chart.complete()
        assert chart.state is state


def test_the_numbers_are_those_of_the_standard() -> None:
    assert [state.value for state in STATES] == list(range(1, 18))
    assert [command.value for command in COMMANDS] == list(range(1, 11))
    assert (Command.ABORT, Command.CLEAR, Command.COMPLETE) == (8, 9, 10)
    assert (State.EXECUTE, State.ABORTED, State.COMPLETED) == (6, 9, 17)
    assert [mode.value for mode in Mode] == [0, 1, 2, 3]


def test_abort_is_possible_everywhere_but_on_its_own_way() -> None:
    without = {state for state in STATES if (state, Command.ABORT) not in ON_COMMAND}
    assert without == {State.ABORTING, State.ABORTED}


def test_every_way_ends_in_a_state_that_waits() -> None:
    for state in STATES:
        end = requested(state)
        assert end is State.EXECUTE or end not in WHEN_DONE


@pytest.mark.parametrize(
    ("state", "mode", "command", "code"),
    [
        (State.IDLE, Mode.PRODUCTION, 0, RejectCode.COMMAND_UNDEFINED),
        (State.IDLE, Mode.PRODUCTION, 11, RejectCode.COMMAND_UNDEFINED),
        (State.IDLE, Mode.PRODUCTION, 65535, RejectCode.COMMAND_UNDEFINED),
        (State.IDLE, Mode.MANUAL, Command.START, RejectCode.STATE_NOT_IN_MODE),
        (State.STOPPED, Mode.MANUAL, Command.RESET, RejectCode.STATE_NOT_IN_MODE),
        (State.HELD, Mode.MANUAL, Command.UNHOLD, RejectCode.STATE_NOT_IN_MODE),
        (State.ABORTED, Mode.MANUAL, Command.CLEAR, RejectCode.NONE),
        (State.EXECUTE, Mode.MAINTENANCE, Command.SUSPEND, RejectCode.STATE_NOT_IN_MODE),
        (State.EXECUTE, Mode.MAINTENANCE, Command.HOLD, RejectCode.NONE),
    ],
)
def test_refusals_have_their_code(state: State, mode: Mode, command: int, code: RejectCode) -> None:
    assert validate_command(state, mode, command) is code


def test_modes_change_only_where_nothing_runs() -> None:
    for state in STATES:
        allowed = validate_mode(state, Mode.MAINTENANCE) is RejectCode.NONE
        assert allowed is (state in MODE_CHANGE_IN)
    assert validate_mode(State.IDLE, 0) is RejectCode.MODE_UNDEFINED
    assert validate_mode(State.IDLE, 32) is RejectCode.MODE_UNDEFINED
    assert validate_mode(State.IDLE, 4) is RejectCode.MODE_NOT_CONFIGURED


def test_every_reject_code_has_words() -> None:
    assert all(code.text for code in RejectCode)


def test_the_documented_machine_is_current() -> None:
    page = Path(__file__).parents[3] / "docs/state-machine.md"
    assert page.read_text(encoding="utf-8") == state_machine_document()
