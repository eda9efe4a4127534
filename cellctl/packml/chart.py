"""The two tables as a `transitions` machine, which alone holds and changes the state."""

from transitions import Machine

from cellctl.packml.command import Command
from cellctl.packml.state import STATES, State
from cellctl.packml.transition_tables import ON_COMMAND, WHEN_DONE

_STATE_COMPLETE = "STATE_COMPLETE"


class StateChart:
    """Changes the state; knows nothing of what the states do.

    It decides nothing either. Whether a command is legal has been decided before, with its reject
    code (``packml.validation``). An event that the tables do not know is therefore a defect of the
    caller, and `transitions` raises its ``MachineError`` instead of ignoring the event.
    """

    state: State
    """The present state; written by `transitions`."""

    def __init__(self, initial: State) -> None:
        # The synchronous machine is enough: no callback hangs on a transition, so there is nothing
        # to wait for, and no other task can ever see a state that is half changed.
        self._machine = Machine(
            model=self, states=list(STATES), initial=initial, auto_transitions=False
        )
        for (source, command), target in ON_COMMAND.items():
            self._machine.add_transition(command.name, source, target)
        for source, target in WHEN_DONE.items():
            self._machine.add_transition(_STATE_COMPLETE, source, target)

    def command(self, command: Command) -> State:
        """Fire a command that is legal in the present state; the state afterwards."""
        self._machine.dispatch(command.name)
        return self.state

    def complete(self) -> State:
        """Fire state complete; the state afterwards."""
        self._machine.dispatch(_STATE_COMPLETE)
        return self.state
