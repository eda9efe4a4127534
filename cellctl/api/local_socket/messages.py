"""The messages of the local API: one JSON object a line, and one answer to each request."""

from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from cellctl.api.local_socket.report import StatusReport
from cellctl.errors.local import MessageMalformed

REQUEST_LIMIT = 4096
"""Bytes of a request with its line end."""
ANSWER_LIMIT = 1 << 20
"""Bytes of an answer. A status with all its texts has some kilobytes; this keeps a program that is
no daemon from filling the memory of its client."""
M = TypeVar("M")
C = TypeVar("C", bound=BaseModel)
FaultNumber = Annotated[int, Field(ge=1, le=9999)]
"""Below 1000: of cellctl; from 1000 on: of processes and drivers of other packages."""
ProcedureNumber = Annotated[int, Field(ge=1, le=65535)]
"""Number of a procedure, as in the line's register."""
Serial = Annotated[str, Field(max_length=24)]


PlainName = Literal["clear", "reset", "hold", "unhold", "stop", "abort"]


class Message(BaseModel):
    """Strict: no unknown keys, no value of another type."""

    # Strict, because a command moves a machine: a number in quotes or a misspelt option is refused,
    # never interpreted.
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class StatusRequest(Message):
    """A question; it changes nothing."""

    request: Literal["status"] = "status"


class RobotRequest(Message):
    """Has the daemon listen to one robot for a while. Asks, changes nothing."""

    request: Literal["robot"] = "robot"
    name: Annotated[str, Field(max_length=64)]
    seconds: Annotated[float, Field(ge=0.5, le=600.0)]


class PlainCommand(Message):
    """A PackML command without parameters."""

    request: PlainName


class StartCommand(Message):
    """Start in Production."""

    request: Literal["start"] = "start"
    serial: Serial
    recipe: Annotated[str, Field(max_length=64)] = ""
    """Name or number; empty for the only recipe of the cell."""
    mate_serial: Annotated[str, Field(max_length=24)] = ""
    """Of the part that it is joined to."""
    order: Annotated[str, Field(max_length=16)] = ""
    dry_run: bool = False
    single_step: bool = False


class ProcedureCommand(Message):
    """Start in Maintenance."""

    request: Literal["procedure"] = "procedure"
    number: ProcedureNumber
    serial: Serial


class ModeCommand(Message):
    """Change the unit mode."""

    request: Literal["mode"] = "mode"
    mode: Literal["production", "maintenance", "manual"]


class AcknowledgeCommand(Message):
    """Acknowledge the alarms with this number that were seen."""

    request: Literal["acknowledge"] = "acknowledge"
    number: FaultNumber
    seen: Annotated[int, Field(ge=0, le=10**9)] = 0
    """How many of them, as ``times`` of the snapshot says; what came later stays. 0 is all."""


CommandRequest = PlainCommand | StartCommand | ProcedureCommand | ModeCommand | AcknowledgeCommand


class GivenCommand(Message):
    """A command of the terminal, with the time at which somebody gave it."""

    request: Literal["given"] = "given"
    given_s: Annotated[float, Field(ge=0, allow_inf_nan=False)]
    """Monotonic time of this PC in seconds."""
    command: Annotated[CommandRequest, Field(discriminator="request")]


Role = Literal["view", "operate", "maintain"]
"""What a person may do on the page; each one includes those before it."""
Word = Annotated[str, Field(pattern=r"^[A-Za-z0-9._-]{1,32}$")]
"""Goes into the audit log as it is."""


class OnBehalf(Message):
    """The person at a page, as the page's process has identified them."""

    person: Word
    role: Role
    panel: Annotated[str, Field(pattern=r"^[A-Za-z0-9._-]{0,32}$")] = ""
    """Name of the panel at the cell; empty for a page elsewhere."""
    reason: Annotated[str, Field(max_length=200)] = ""
    """In the person's words, for the audit log."""
    decision: Annotated[int, Field(ge=0)] | None = None
    """``decision`` of the newest snapshot that the person has seen."""
    key: Annotated[str, Field(pattern=r"^[A-Za-z0-9-]{8,64}$")]
    """The same command twice has the same key, and is obeyed once."""


class PageCommand(Message):
    """A command of a person at a page; only the page's process may send it."""

    request: Literal["page"] = "page"
    on_behalf: OnBehalf
    command: Annotated[CommandRequest, Field(discriminator="request")]


class FollowRequest(Message):
    """From now on the daemon pushes the live view, one JSON object a line."""

    request: Literal["follow"] = "follow"


Request = StatusRequest | RobotRequest | FollowRequest | PageCommand | GivenCommand | CommandRequest


class Taken(Message):
    """The command is being executed; the status shows where it leads."""

    answer: Literal["taken"] = "taken"
    state: str


class Refused(Message):
    """The command is not executed."""

    answer: Literal["refused"] = "refused"
    code: int
    """Reject code, the same as the line's ``reject_code``."""
    text: str
    state: str
    permitted: tuple[str, ...] = ()
    """Names of the commands that would be taken now."""
    remedy: str = ""
    """What to do first, in words; empty where ``permitted`` and ``known`` say it."""
    known: tuple[str, ...] = ()
    """Recipes or procedures of this cell, where an unknown one was named."""


class Failed(Message):
    """The request was not understood, or a fault kept the daemon from answering it."""

    answer: Literal["failed"] = "failed"
    number: int
    """Number in the fault catalogue."""
    text: str


class StatusAnswer(Message):
    """Answer to a status request."""

    answer: Literal["status"] = "status"
    report: StatusReport


class RobotAnswer(Message):
    """Answer to a robot request."""

    answer: Literal["robot"] = "robot"
    cell: str
    """Name of the cell, by which a service of another one is told."""
    heard: dict[str, dict[str, Any]]
    """What was heard, by part and name."""


Answer = Taken | Refused | Failed | StatusAnswer | RobotAnswer

_REQUEST: TypeAdapter[Request] = TypeAdapter(Annotated[Request, Field(discriminator="request")])
_ANSWER: TypeAdapter[Answer] = TypeAdapter(Annotated[Answer, Field(discriminator="answer")])


def parse_request(line: bytes) -> Request:
    """A request from its line; raises ``MessageMalformed``."""
    return _parse(_REQUEST, line)


def parse_answer(line: bytes) -> Answer:
    """An answer from its line; raises ``MessageMalformed``."""
    return _parse(_ANSWER, line)


def made(kind: type[C], **values: object) -> C:
    """A message with values that a user typed; raises ``MessageMalformed``."""
    try:
        return kind.model_validate(values)
    except ValidationError as error:
        raise _malformed(error) from error


def to_line(message: Message) -> bytes:
    """The line of a message."""
    return message.model_dump_json().encode() + b"\n"


def _parse(adapter: TypeAdapter[M], line: bytes) -> M:
    try:
        return adapter.validate_json(line)
    except ValidationError as error:
        raise _malformed(error) from error


def _malformed(error: ValidationError) -> MessageMalformed:
    # Without the input: what a client has sent would otherwise come back to it, and into the log.
    first = error.errors(include_url=False, include_context=False, include_input=False)[0]
    place = ".".join(str(part) for part in first["loc"])
    return MessageMalformed(f"{place}: {first['msg']}" if place else first["msg"])
