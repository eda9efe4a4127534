"""The PackML state machine of the unit; one command or fault at a time changes its state."""

import asyncio
from collections import deque
from collections.abc import Callable, Mapping

from cellctl.clock import now_s
from cellctl.errors.base import CellError, Reaction
from cellctl.errors.internal import Unexpected
from cellctl.packml.activities import Action, Activities, Task
from cellctl.packml.chart import StateChart
from cellctl.packml.command import Command
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State
from cellctl.packml.transition_tables import ON_COMMAND, requested
from cellctl.packml.validation import MODE_REQUEST, Refusal, validate_command, validate_mode

Gate = Callable[[State, Command], RejectCode]

_PAUSE_COMMANDS = {Command.HOLD: State.HELD, Command.SUSPEND: State.SUSPENDED}
"""Commands that Execute obeys at its next safe point, and the state that each leads to."""
_BEFORE_EXECUTE = frozenset({State.STARTING, State.UNHOLDING, State.UNSUSPENDING})
"""States that lead to Execute; a Hold that comes in them waits for its first safe point."""
_ACTS_WITHOUT_PAUSE = frozenset({State.RESETTING})
"""Robots may move, and there is no safe point: what would hold elsewhere stops here."""
_RELEASES_FAULTS = frozenset({Command.CLEAR, Command.RESET, Command.UNHOLD})
"""Commands by which somebody says that the cause of the faults is gone."""
_LEADS_TO = {
    Reaction.HOLD: (Command.HOLD, Command.STOP, Command.ABORT),
    Reaction.WARN: (Command.STOP, Command.ABORT),
    Reaction.STOP: (Command.STOP, Command.ABORT),
    Reaction.ABORT: (Command.ABORT,),
}
"""First command that the present state allows; a coroutine that ended cannot just be warned of."""


class PackMLMachine:
    """Built from the two tables; the coroutines of the acting states come from outside.

    An acting state and Execute end when their coroutine returns. A ``CellError`` in it leads, by
    its reaction, to Holding, Stopping or Aborting; any other exception to Aborting. Faults latch
    until the command that leaves Held, Stopped or Aborted is accepted (Unhold, Reset, Clear).
    All methods belong to one event loop. Observers (``on_change``, ``on_fault``) must not raise.
    """

    def __init__(
        self,
        actions: Mapping[State, Action],
        *,
        initial: State = State.ABORTED,
        gate: Gate = lambda _state, _command: RejectCode.NONE,
        leave_timeout_s: float = 10.0,
    ) -> None:
        """``gate`` may refuse what the tables allow; it must be quick and free of effects."""
        if initial not in (State.ABORTED, State.STOPPED):
            raise ValueError("a unit starts Aborted or Stopped")
        self._chart = StateChart(initial)
        self._activities = Activities(actions, self._ended, leave_timeout_s)
        self._gate = gate
        self._mode = Mode.PRODUCTION
        self._pause: Command | None = None
        """Hold or Suspend, noted for the next safe point."""
        # Every change of state happens while it is held. So no two of them mix, although observers
        # and safe points may give other tasks a turn.
        self._turn = asyncio.Lock()
        self._changed = asyncio.Event()
        self._reactions: set[asyncio.Task[None]] = set()
        self._faults: list[CellError] = []
        self.mode_since_s = self.state_since_s = now_s()
        """Monotonic time of the last change of mode and of state."""
        self.refusals: deque[Refusal] = deque(maxlen=8)
        self.on_change: list[Callable[[State, State], None]] = []
        self.on_fault: list[Callable[[CellError], None]] = []

    @property
    def state(self) -> State:
        """StateCurrent."""
        return self._chart.state

    @property
    def state_requested(self) -> State:
        """StateRequested: where the unit is on its way to; Held while Hold waits its safe point."""
        return _PAUSE_COMMANDS[self._pause] if self._pause else requested(self.state)

    @property
    def mode(self) -> Mode:
        """UnitModeCurrent."""
        return self._mode

    @property
    def hold_requested(self) -> bool:
        """True between Hold or Suspend and the safe point that obeys it."""
        return self._pause is not None

    @property
    def fault(self) -> CellError | None:
        """The first fault since the latch was released: StopReason."""
        return self._faults[0] if self._faults else None

    @property
    def faults(self) -> tuple[CellError, ...]:
        """All latched faults, oldest first."""
        return tuple(self._faults)

    def validate(self, command: int) -> RejectCode:
        """Why a command would be refused now; NONE when it would be executed."""
        code = validate_command(self.state, self._mode, command)
        return code or self._gate(self.state, Command(command))

    async def command(self, command: int) -> RejectCode:
        """Execute a command or refuse it.

        Returns once the state has changed, or once Hold or Suspend is noted for the next safe
        point of Execute.
        """
        code = self.validate(command)
        if code is RejectCode.NONE:
            async with self._turn:
                # Validated again: the state may have changed while the command waited its turn.
                code = self.validate(command)
                if code is RejectCode.NONE:
                    self._execute(Command(command))
        if code is not RejectCode.NONE:
            self.refused(command, code)
        return code

    async def set_mode(self, mode: int) -> RejectCode:
        """Change the unit mode, in Stopped, Idle or Aborted only."""
        async with self._turn:
            code = validate_mode(self.state, mode)
            if code is RejectCode.NONE:
                # Asking for the mode that is set already must not start its time anew:
                # ModeTimeCurrent is shown to the line.
                if mode != self._mode:
                    self.mode_since_s = now_s()
                self._mode = Mode(mode)
                self._announce()
        if code is not RejectCode.NONE:
            self.refused(0, code, mode)
        return code

    async def safe_point(self) -> bool:
        """Called by Execute where it may pause: obeys a pending Hold or Suspend.

        Returns True when the unit was held in between, so whatever was measured before may no
        longer be true; False at once when nothing is pending.
        """
        paused = False
        # A loop, because a second Hold may be noted while Execute was parked or waited for its
        # turn.
        while self._pause is not None and self.state is State.EXECUTE:
            async with self._turn:
                if self._pause is None or self.state is not State.EXECUTE:
                    continue
                self._fire(self._pause)
            await self._activities.resumed()
            paused = True
        return paused

    async def fail(self, error: CellError) -> None:
        """A fault from outside the state's coroutine: guard, line, device supervision."""
        async with self._turn:
            state, reaction = self.state, error.reaction
            on_the_way = state is State.EXECUTE or state in _BEFORE_EXECUTE
            # On the way to Execute too: Starting and Unholding move robots, and the first safe
            # point of Execute is the next place where they may stand.
            if reaction is Reaction.HOLD and on_the_way:
                self._pause = Command.HOLD
                self._latch(error)
                self._announce()
                return
            command = {Reaction.HOLD: Command.HOLD, Reaction.STOP: Command.STOP}.get(
                reaction, Command.ABORT
            )
            if command is Command.HOLD and state in _ACTS_WITHOUT_PAUSE:
                command = Command.STOP
            if reaction is Reaction.WARN or (state, command) not in ON_COMMAND:
                self._report(error)  # nothing moves that it could end
                return
            # What observers do with a fault may fail or wait for a disk; a stop may not.
            self._faults.append(error)
            self._fire(command)
            self._report(error)

    async def wait_for(self, *states: State, timeout_s: float | None = None) -> State:
        """Wait until the unit is in one of the states; raises ``TimeoutError``.

        None waits for ever.
        """
        async with asyncio.timeout(timeout_s):
            while self.state not in states:
                await self._changed.wait()
        return self.state

    async def beat_while_alive(self, beat: Callable[[], None], period_s: float = 0.25) -> None:
        """Call ``beat`` for ever, each time only after the machine has taken a turn.

        So the heartbeat that the line sees stops when the state machine hangs, even if the rest of
        the daemon goes on.
        """
        while True:
            async with self._turn:
                beat()
            await asyncio.sleep(period_s)

    async def close(self) -> None:
        """Cancel what runs. Does not stop devices: Abort first and wait for Aborted."""
        await self._activities.close()
        for reaction in self._reactions:
            reaction.cancel()
        await asyncio.gather(*self._reactions, return_exceptions=True)

    def _execute(self, command: Command) -> None:
        if command in _RELEASES_FAULTS:
            self._faults.clear()
        if self.state is State.EXECUTE and command in _PAUSE_COMMANDS:
            # Execute pauses only where the step says that it is safe. A pending Hold, whose cause
            # lies in this cell, is not replaced by a later Suspend, whose cause lies in the line.
            if self._pause is not Command.HOLD:
                self._pause = command
            self._announce()
        else:
            self._fire(command)

    def _fire(self, command: Command | None) -> None:
        """Change the state by a command, or by state complete; holds the turn."""
        previous = self.state
        state = self._chart.complete() if command is None else self._chart.command(command)
        if state is not State.EXECUTE and state not in _BEFORE_EXECUTE:
            self._pause = None
        self.state_since_s = now_s()
        self._activities.follow(previous, state)
        self._announce(previous)

    def _ended(self, task: Task, error: BaseException | None) -> None:
        reaction = asyncio.create_task(self._after(task, error))
        self._reactions.add(reaction)
        reaction.add_done_callback(self._reactions.discard)

    async def _after(self, task: Task, error: BaseException | None) -> None:
        """The coroutine of a state has ended: go on, unless a command was quicker."""
        async with self._turn:
            if not self._activities.is_current(task):
                # The state has been left already. A fault in the clean-up must not be lost, but the
                # state that came after has its own reaction to whatever ended this one.
                if isinstance(error, Exception):
                    self._latch(self._fault(error))
                return
            if error is None:
                self._fire(None)
                return
            fault = self._fault(error)
            self._faults.append(fault)
            # The state first and the observers afterwards: what they do may fail, and a stop must
            # not wait for it.
            self._fire(self._reaction_to(fault))
            self._report(fault)

    def _reaction_to(self, fault: CellError) -> Command | None:
        if self.state is State.ABORTING:
            return None  # nothing is stronger than Aborting: it ends in Aborted, fault latched
        allowed = (c for c in _LEADS_TO[fault.reaction] if (self.state, c) in ON_COMMAND)
        # Abort is allowed from every state but Aborting and Aborted, so there always is one.
        return next(allowed)

    def _fault(self, error: BaseException) -> CellError:
        if isinstance(error, CellError):
            return error
        fault = Unexpected(f"{type(error).__name__} in {self.state.name}: {error}")
        # The traceback of the original exception stays in the log; the line sees only the number.
        fault.__cause__ = error
        return fault

    def _latch(self, error: CellError) -> None:
        self._faults.append(error)
        self._report(error)

    def _report(self, error: CellError) -> None:
        for observer in self.on_fault:
            observer(error)

    def refused(self, command: int, code: RejectCode, mode: int = 0) -> None:
        """Keep a refusal; also called by whoever refuses before the machine is asked.

        A refused ``mode`` is given where there is no command.
        """
        request, number = f"command {command}", command
        if not command and mode:
            request, number = f"mode {mode}", MODE_REQUEST + mode
        self.refusals.append(Refusal(now_s(), self._mode, self.state, request, code, number))

    def _announce(self, previous: State | None = None) -> None:
        # A new event for each change: whoever waits from now on waits for the next one.
        self._changed.set()
        self._changed = asyncio.Event()
        for observer in self.on_change:
            observer(self.state if previous is None else previous, self.state)
