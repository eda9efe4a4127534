"""Turns the requests of operators into commands, which are validated like those of the line PLC."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from cellctl import log
from cellctl.api.local_socket.live_view import LiveView
from cellctl.api.local_socket.messages import (
    AcknowledgeCommand,
    Answer,
    CommandRequest,
    FollowRequest,
    GivenCommand,
    ModeCommand,
    PageCommand,
    PlainCommand,
    ProcedureCommand,
    Refused,
    Request,
    RobotAnswer,
    RobotRequest,
    StartCommand,
    StatusAnswer,
    StatusRequest,
    Taken,
)
from cellctl.api.local_socket.page_desk import PageDesk
from cellctl.api.local_socket.refusal_remedy import remedy
from cellctl.api.local_socket.reporter import Reporter
from cellctl.api.local_socket.users import Users
from cellctl.clock import Monotonic, now_s
from cellctl.command.submission import NoteRefusal, Submission, Submit
from cellctl.config import CellConfig
from cellctl.packml.command import Command
from cellctl.packml.machine import PackMLMachine
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.unit_command import Options, Source, UnitCommand

_log = log.get(__name__)


@dataclass(frozen=True, slots=True, eq=False)
class TerminalSubmission(Submission):
    """Remembers the state that its command has led to."""

    machine: PackMLMachine
    details: Mapping[str, str] = field(default_factory=dict)
    """What the audit log is told besides the command."""
    state: list[str] = field(default_factory=list)
    """Empty until the command is being executed."""

    @property
    def reference(self) -> Mapping[str, int | str]:
        """What the audit log is told besides the command."""
        return self.details

    def taken(self) -> None:
        """Before the answer waits for its record: a short state may have ended until then."""
        self.state.append(self.machine.state.name)


class Terminal:
    """Handles the requests of the local API. Belongs to one event loop."""

    def __init__(
        self,
        config: CellConfig,
        machine: PackMLMachine,
        submit: Submit,
        reporter: Reporter,
        view: LiveView,
        *,
        note_refusal: NoteRefusal,
        given_s: Monotonic = now_s,
    ) -> None:
        """``given_s``: since when a command that is read now may have waited, monotonic time."""
        self._config = config
        self._machine = machine
        self._submit = submit
        self._note_refusal = note_refusal
        self._given_s = given_s
        self._reporter = reporter
        self._view = view
        self._users = Users()
        page_user = config.local_api.page_user
        self._desk = PageDesk(page_user, self._users, view.look, self._obey, self._turned_down)

    async def handle(self, request: Request, uid: int) -> Answer:
        """Answer a request of the user with this number.

        A command is being executed, or is refused, when this returns.
        """
        if isinstance(request, StatusRequest):
            return StatusAnswer(report=await self._reporter.report())
        if isinstance(request, RobotRequest):
            heard = await self._reporter.robot(request.name, request.seconds)
            return RobotAnswer(cell=self._config.name, heard=heard)
        if isinstance(request, PageCommand):
            return await self._desk.handle(request, uid)
        assert not isinstance(request, FollowRequest), "the server sees to those who follow"
        # Before the user is looked up, because the time of a command is that at which it was given.
        if isinstance(request, GivenCommand):
            command = self._command(request.command).given_at(request.given_s)
        else:
            command = self._command(request).given_at(self._given_s())
        if not command.ends_motion:
            # A directory service may take a second, which a Stop cannot wait.
            await self._users.look_up(uid)
        asked = request.command if isinstance(request, GivenCommand) else request
        person = self._users.name(uid)
        return await self._submitted(replace(command, person=person), _named(asked, command))

    async def _obey(
        self, request: CommandRequest, person: str, details: Mapping[str, str]
    ) -> Taken | Refused:
        """A command of a page, whose person is known."""
        command = self._of_page(request, person)
        return await self._submitted(command, {**details, **_named(request, command)})

    def _turned_down(
        self, request: CommandRequest, person: str, code: RejectCode, details: Mapping[str, str]
    ) -> None:
        self._note_refusal(self._of_page(request, person), code, details)

    def _of_page(self, request: CommandRequest, person: str) -> UnitCommand:
        command = replace(self._command(request), source=Source.PAGE, person=person)
        return command.given_at(self._given_s())

    async def _submitted(self, command: UnitCommand, details: Mapping[str, str]) -> Taken | Refused:
        # The same validator and queue as for the line; nothing is decided here.
        submission = TerminalSubmission(command, self._machine, details)
        code = await self._submit(submission)
        state = (submission.state or [self._machine.state.name])[0]
        name = Command(command.cntrl_cmd).name.lower()
        _log.info("local command", who=command.who, cmd=name, reject=code.text)
        if code is RejectCode.NONE:
            return Taken(state=state)
        known = self._known(command.in_mode) if code is RejectCode.RECIPE_UNKNOWN else ()
        return Refused(
            code=code,
            text=code.text,
            state=state,
            permitted=self._view.permitted(),
            remedy=remedy(code, command),
            known=known,
        )

    def _known(self, mode: int) -> tuple[str, ...]:
        """What a Start in this mode could have named."""
        if mode == Mode.MAINTENANCE:
            return tuple(f"{number} {label}" for number, label in self._view.procedures())
        return tuple(f"{recipe.id} {recipe.name}" for recipe in self._config.recipes)

    def _command(self, request: CommandRequest) -> UnitCommand:
        """The command that a request means, given now."""
        match request:
            case PlainCommand():
                return UnitCommand(Source.TERMINAL, cntrl_cmd=Command[request.request.upper()])
            case StartCommand():
                return UnitCommand(
                    Source.TERMINAL,
                    cntrl_cmd=Command.START,
                    in_mode=Mode.PRODUCTION,
                    recipe_id=self._recipe_id(request.recipe),
                    options=_options(request),
                    serial=request.serial,
                    mate_serial=request.mate_serial,
                    order=request.order,
                )
            case ProcedureCommand():
                return UnitCommand(
                    Source.TERMINAL,
                    cntrl_cmd=Command.START,
                    in_mode=Mode.MAINTENANCE,
                    recipe_id=request.number,
                    serial=request.serial,
                )
            case ModeCommand():
                return UnitCommand(Source.TERMINAL, unit_mode=Mode[request.mode.upper()])
            case AcknowledgeCommand():
                return UnitCommand(
                    Source.TERMINAL, alarm_ack_id=request.number, alarms_seen=request.seen
                )

    def _recipe_id(self, wanted: str) -> int:
        """Number of a recipe by name or number; 0, which no recipe has, when there is none."""
        recipes = self._config.recipes
        if not wanted and len(recipes) == 1:
            return recipes[0].id
        found = [recipe.id for recipe in recipes if wanted in (recipe.name, str(recipe.id))]
        # Two recipes may have one name, and a name may be another one's number. Nothing is guessed:
        # the validator refuses 0 with the reject code that the line would get.
        return found[0] if len(found) == 1 else 0


def _named(request: CommandRequest, command: UnitCommand) -> Mapping[str, str]:
    """The name of a recipe that this cell does not have: its number, 0, would not tell it."""
    if isinstance(request, StartCommand) and request.recipe and not command.recipe_id:
        return {"recipe_named": request.recipe}
    return {}


def _options(request: StartCommand) -> Options:
    dry_run = Options.DRY_RUN if request.dry_run else Options.NONE
    single_step = Options.SINGLE_STEP if request.single_step else Options.NONE
    return dry_run | single_step
