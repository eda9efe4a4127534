"""The line's commands on the state machine, and how each of them ends."""

from collections.abc import Callable

from cellctl.packml.command import Command
from cellctl.packml.machine import PackMLMachine
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.result import Result
from cellctl.packml.state import State
from cellctl.packml.unit_command import UnitCommand
from cellctl.packml.validation import validate_command, validate_mode

Finish = Callable[[int, Result], object]

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
"""Where every command ends, though it may have wanted to go elsewhere."""


class LineCoupling:
    """Obeys one command at a time and reports its end.

    A command ends when the unit reaches its goal, or Stopped, Aborted or Completed instead. Start
    and Complete end with the result of the run.
    """

    def __init__(
        self, machine: PackMLMachine, finish: Finish, run_result: Callable[[], Result]
    ) -> None:
        """``finish`` is ``PlcPort.finish``; ``run_result`` is asked in Completed."""
        self._machine = machine
        self._finish = finish
        self._run_result = run_result
        self._pursued: tuple[int, Command] | None = None
        machine.on_change.append(self._changed)

    async def obey(self, command: UnitCommand) -> RejectCode:
        """Change the mode if asked, then command the unit. Stop and Abort change no mode.

        A mode that is set already counts as reached. A command of the terminal may end one of the
        line, and takes the place of none.
        """
        machine = self._machine
        changes_mode = command.unit_mode not in (0, machine.mode) and not command.ends_motion
        if changes_mode:
            code = self._refused_in_new_mode(command) or await machine.set_mode(command.unit_mode)
            if code is not RejectCode.NONE:
                return code
        if command.cntrl_cmd == Command.UNDEFINED and (command.unit_mode or command.alarm_ack_id):
            self._finish(command.seq, Result.GOOD)
            return RejectCode.NONE
        if command.local:
            return await machine.command(command.cntrl_cmd)
        before, self._pursued = self._pursued, None
        if command.cntrl_cmd in _GOAL:
            self._pursued = command.seq, Command(command.cntrl_cmd)
        code = await machine.command(command.cntrl_cmd)
        if code is not RejectCode.NONE:
            self._pursued = before
        return code

    def _refused_in_new_mode(self, command: UnitCommand) -> RejectCode:
        """A command that is refused leaves the mode as it was, too."""
        state = self._machine.state
        if command.cntrl_cmd == Command.UNDEFINED or validate_mode(state, command.unit_mode):
            return RejectCode.NONE
        return validate_command(state, Mode(command.unit_mode), command.cntrl_cmd)

    def _changed(self, before: State, after: State) -> None:
        if self._pursued is None or before is after:
            return
        seq, command = self._pursued
        if after is _GOAL[command]:
            reached = after is State.COMPLETED
            result = self._run_result() if reached else Result.GOOD
        elif after in _ENDS:
            result = _ENDS[after]
        else:
            return
        self._pursued = None
        self._finish(seq, result)
