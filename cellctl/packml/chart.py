"""The tables as a `transitions` machine: it alone holds and changes the state."""

from typing import Any

from transitions.extensions.asyncio import AsyncMachine

from cellctl.packml.command import Command
from cellctl.packml.state import STATES, State
from cellctl.packml.tables import ON_COMMAND, WHEN_DONE

_DONE = "done"


class _Unit:
    """The model that `transitions` writes the state to."""

    state: Any


class StateChart:
    """Fires events; knows nothing of what the states do.

    The queue of `transitions` answers True for every queued event, so the caller asks for the
    state afterwards; ``PackMLMachine`` lets one event through at a time.
    """

    def __init__(self, initial: State) -> None:
        self._unit: Any = _Unit()
        self._machine = AsyncMachine(
            model=self._unit,
            states=[state.name for state in STATES],
            transitions=[
                *([c.name, source.name, target.name] for (source, c), target in ON_COMMAND.items()),
                *([_DONE, source.name, target.name] for source, target in WHEN_DONE.items()),
            ],
            initial=initial.name,
            queued=True,
            auto_transitions=False,
            ignore_invalid_triggers=True,
        )

    @property
    def state(self) -> State:
        """The present state."""
        return State[self._unit.state]

    async def command(self, command: Command) -> State:
        """Fire a command; the state afterwards, unchanged if the tables do not know it."""
        await self._unit.trigger(command.name)
        return self.state

    async def done(self) -> State:
        """Fire state complete; the state afterwards."""
        await self._unit.trigger(_DONE)
        return self.state
