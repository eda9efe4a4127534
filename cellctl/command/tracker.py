"""Gives commands to the state machine and reports how each of them ends."""

from collections.abc import Callable

from cellctl.command.submission import Submission
from cellctl.command.validator import validate_in_new_mode
from cellctl.packml.command import Command
from cellctl.packml.machine import PackMLMachine
from cellctl.packml.reject import RejectCode
from cellctl.packml.result import Result
from cellctl.packml.state import State
from cellctl.packml.unit_command import Source

_GOAL = {
    Command.RESET: State.IDLE,
    Command.START: State.COMPLETED,
    Command.STOP: State.STOPPED,
    Command.HOLD: State.HELD,
    Command.UNHOLD: State.EXECUTE,
    Command.SUSPEND: State.SUSPENDED,
    Command.UNSUSPEND: State.EXECUTE,
    Command.ABORT: State.ABORTED,
    Command.CLEAR: State.STOPPED,
    Command.COMPLETE: State.COMPLETED,
}
_ENDS = {State.STOPPED: Result.STOPPED, State.ABORTED: Result.ABORTED, State.COMPLETED: Result.BAD}
"""States that end every command, also one with another goal."""


class CommandTracker:
    """Follows one command of each source to its end.

    A command ends when the unit reaches the command's goal, or Stopped, Aborted or Completed
    instead. Start and Complete end with the result of the run. A later command of the same source
    takes the place of an earlier one, whose end is then not reported; a command of another source
    may end it, but does not take its place.
    """

    def __init__(self, machine: PackMLMachine, run_result: Callable[[], Result]) -> None:
        """``run_result``: result of the last run; asked for in Completed."""
        self._machine = machine
        self._run_result = run_result
        self._pursued: dict[Source, Submission] = {}
        machine.on_change.append(self._changed)

    async def execute(self, submission: Submission) -> RejectCode:
        """Change the mode if asked, then command the unit; Stop and Abort change no mode.

        A mode that is set already counts as reached.
        """
        command, machine = submission.command, self._machine
        if command.unit_mode not in (0, machine.mode) and not command.ends_motion:
            code = validate_in_new_mode(command, machine.state)
            if code is not RejectCode.NONE:
                machine.refused(command.cntrl_cmd, code)
                return code
            code = await machine.set_mode(command.unit_mode)
            if code is not RejectCode.NONE:
                return code
        if command.cntrl_cmd == Command.UNDEFINED and (command.unit_mode or command.alarm_ack_id):
            submission.ended(Result.GOOD)  # the mode is set, or the alarm was acknowledged before
            return RejectCode.NONE
        return await self._command(submission)

    async def _command(self, submission: Submission) -> RejectCode:
        number, source = submission.command.cntrl_cmd, submission.command.source
        # Pursued before the machine is commanded: it may reach the goal before it returns.
        before = self._pursued.pop(source, None)
        if number in _GOAL:
            self._pursued[source] = submission
        code = await self._machine.command(number)
        if code is not RejectCode.NONE:
            self._pursued.pop(source, None)
            # A refused command does not end the pursuit of the one before, which goes on as if
            # nothing had been asked.
            if before is not None:
                self._pursued[source] = before
        return code

    def _changed(self, before: State, after: State) -> None:
        # Told also for a Hold that is only noted; no goal is reached by that.
        if before is after:
            return
        for source, submission in tuple(self._pursued.items()):
            result = self._result(Command(submission.command.cntrl_cmd), after)
            if result is not Result.NONE:
                del self._pursued[source]
                submission.ended(result)

    def _result(self, command: Command, state: State) -> Result:
        """How a command has ended when the unit arrives in this state; NONE when it has not."""
        if state is not _GOAL[command]:
            return _ENDS.get(state, Result.NONE)
        return self._run_result() if state is State.COMPLETED else Result.GOOD
