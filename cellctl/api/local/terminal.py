"""What operators ask for, as commands for the same judge that the line's commands come before."""

from dataclasses import replace

from cellctl import log
from cellctl.api.local.messages import (
    AcknowledgeCommand,
    Answer,
    CommandRequest,
    ModeCommand,
    PlainCommand,
    ProcedureCommand,
    Refused,
    Request,
    StartCommand,
    Status,
    StatusRequest,
    Taken,
)
from cellctl.api.local.reporter import Reporter
from cellctl.api.local.users import Users
from cellctl.command.arbiter import Line
from cellctl.config import CellConfig
from cellctl.packml.command import Command
from cellctl.packml.machine import PackMLMachine
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.unit_command import DRY_RUN, SINGLE_STEP, UnitCommand

_log = log.get(__name__)


class Terminal:
    """Handles the requests of the local API. Belongs to one event loop."""

    def __init__(
        self, config: CellConfig, machine: PackMLMachine, line: Line, reporter: Reporter
    ) -> None:
        self._config = config
        self._machine = machine
        self._line = line
        self._reporter = reporter
        self._users = Users()

    async def handle(self, request: Request, uid: int) -> Answer:
        """Answer a request; a command is obeyed or refused when this returns."""
        if isinstance(request, StatusRequest):
            return Status(report=await self._reporter.report())
        command = replace(self._command(request), by=self._users.actor(uid))
        if not command.ends_motion:
            await self._users.look_up(uid)
            command = replace(command, by=self._users.actor(uid))
        code = command.judge() or await self._line.take(command)
        state = self._machine.state.name
        _log.info("local command", who=command.who, cmd=request.request, reject=code.text)
        if code is RejectCode.NONE:
            return Taken(state=state)
        return Refused(code=code, text=code.text, state=state)

    def _command(self, request: CommandRequest) -> UnitCommand:
        match request:
            case PlainCommand():
                return _asked(cntrl_cmd=Command[request.request.upper()])
            case StartCommand():
                return _asked(
                    cntrl_cmd=Command.START,
                    unit_mode=Mode.PRODUCTION,
                    recipe_id=self._recipe_id(request.recipe),
                    options=DRY_RUN * request.dry_run | SINGLE_STEP * request.single_step,
                    serial=request.serial,
                    order=request.order,
                )
            case ProcedureCommand():
                return _asked(
                    cntrl_cmd=Command.START,
                    unit_mode=Mode.MAINTENANCE,
                    recipe_id=request.number,
                    serial=request.serial,
                )
            case ModeCommand():
                return _asked(unit_mode=Mode[request.mode.upper()])
            case AcknowledgeCommand():
                return _asked(alarm_ack_id=request.number)

    def _recipe_id(self, wanted: str) -> int:
        """Number of a recipe by name or number; 0, which no recipe has, when there is none."""
        recipes = self._config.recipes
        if not wanted and len(recipes) == 1:
            return recipes[0].id
        found = [recipe.id for recipe in recipes if wanted in (recipe.name, str(recipe.id))]
        return found[0] if len(found) == 1 else 0


def _asked(
    *,
    cntrl_cmd: Command = Command.UNDEFINED,
    unit_mode: int = 0,
    recipe_id: int = 0,
    options: int = 0,
    serial: str = "",
    order: str = "",
    alarm_ack_id: int = 0,
) -> UnitCommand:
    """A command that arrives now, without a number."""
    return UnitCommand(
        seq=0,
        unit_mode=unit_mode,
        cntrl_cmd=cntrl_cmd,
        recipe_id=recipe_id,
        options=options,
        serial=serial,
        order=order,
        alarm_ack_id=alarm_ack_id,
    )
