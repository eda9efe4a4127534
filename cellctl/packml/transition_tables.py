"""The whole machine as data: where each command leads, and where each finished state leads.

ISA-TR88.00.02, 2022 edition, with its default masks. Nothing else in cellctl decides about states;
`docs/state-machine.md` is generated from here.
"""

from cellctl.packml.command import Command
from cellctl.packml.mode import Mode
from cellctl.packml.state import STATES, State

# As in the standard: Stop is weaker than Abort, and from Aborted only Clear leads to Stopped.
_NO_STOP = (State.STOPPED, State.STOPPING, State.CLEARING, State.ABORTING, State.ABORTED)
_NO_ABORT = (State.ABORTING, State.ABORTED)

ON_COMMAND: dict[tuple[State, Command], State] = {
    (State.STOPPED, Command.RESET): State.RESETTING,
    (State.COMPLETED, Command.RESET): State.RESETTING,
    (State.IDLE, Command.START): State.STARTING,
    (State.EXECUTE, Command.HOLD): State.HOLDING,
    (State.SUSPENDED, Command.HOLD): State.HOLDING,
    (State.HELD, Command.UNHOLD): State.UNHOLDING,
    (State.EXECUTE, Command.SUSPEND): State.SUSPENDING,
    (State.SUSPENDED, Command.UNSUSPEND): State.UNSUSPENDING,
    (State.EXECUTE, Command.COMPLETE): State.COMPLETING,
    (State.SUSPENDED, Command.COMPLETE): State.COMPLETING,
    (State.HELD, Command.COMPLETE): State.COMPLETING,
    (State.ABORTED, Command.CLEAR): State.CLEARING,
    **{(state, Command.STOP): State.STOPPING for state in STATES if state not in _NO_STOP},
    **{(state, Command.ABORT): State.ABORTING for state in STATES if state not in _NO_ABORT},
}

WHEN_DONE: dict[State, State] = {
    State.RESETTING: State.IDLE,
    State.STARTING: State.EXECUTE,
    State.EXECUTE: State.COMPLETING,
    State.COMPLETING: State.COMPLETED,
    State.HOLDING: State.HELD,
    State.UNHOLDING: State.EXECUTE,
    State.SUSPENDING: State.SUSPENDED,
    State.UNSUSPENDING: State.EXECUTE,
    State.STOPPING: State.STOPPED,
    State.ABORTING: State.ABORTED,
    State.CLEARING: State.STOPPED,
}

MODE_CHANGE_IN = frozenset({State.STOPPED, State.IDLE, State.ABORTED})
"""States in which the mode may change: nothing runs that was begun in the old one."""

NOT_IN_MODE: dict[Mode, frozenset[State]] = {
    Mode.PRODUCTION: frozenset(),
    Mode.MAINTENANCE: frozenset({State.SUSPENDING, State.UNSUSPENDING, State.SUSPENDED}),
    Mode.MANUAL: frozenset({State.RESETTING, State.STARTING, State.UNHOLDING, State.UNSUSPENDING}),
}
"""States that a command may not lead to in a mode. In Manual: whatever arms or moves a robot."""


def requested(state: State) -> State:
    """The state that a state is on its way to: StateRequested. Execute counts as a place to be."""
    while state is not State.EXECUTE and state in WHEN_DONE:
        state = WHEN_DONE[state]
    return state
