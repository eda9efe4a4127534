"""Commands to the cell: brought to the daemon, which decides."""

from typing import Annotated, Any

from fastapi import APIRouter, Header, Path, Request
from pydantic import BaseModel, ConfigDict, Field

from cellctl import log
from cellctl.api.local_socket.messages import (
    CommandRequest,
    Failed,
    OnBehalf,
    PageCommand,
    Refused,
    Taken,
)
from cellctl.clock import now_s
from cellctl.errors.local import DaemonNotReached, StopNotDelivered
from cellctl.hmi.answers.commands import CommandTold, command_told
from cellctl.hmi.daemon_link import AnswerMissing
from cellctl.hmi.problems import Problem
from cellctl.hmi.visitors.access import OWN_PAGE, Asked, Visitor
from cellctl.packml.reject import RejectCode

router = APIRouter(tags=["commands"])
_log = log.get(__name__)
UNLIMITED = frozenset({"stop", "abort"})
_STATUS = {
    RejectCode.ROLE_MISSING: 403,
    RejectCode.NOT_AT_A_PANEL: 403,
    # The precondition was the state that the person saw.
    RejectCode.SUPERSEDED: 412,
}


class CommandBody(BaseModel):
    """A command as a person gave it."""

    model_config = ConfigDict(extra="forbid", use_attribute_docstrings=True)

    command: Annotated[CommandRequest, Field(discriminator="request")]
    decision: Annotated[int, Field(ge=0)] | None = None
    """``decision`` of the snapshot that the person saw; not needed for stop and abort."""
    reason: Annotated[str, Field(max_length=200)] = ""
    """In the person's words, for the audit log."""


KEY = r"^[A-Za-z0-9-]{8,64}$"
Key = Annotated[
    str,
    Header(
        alias="Idempotency-Key",
        pattern=KEY,
        description="Chosen anew for each command; with the same again nothing is repeated.",
    ),
]


@router.post("/commands", status_code=202, dependencies=OWN_PAGE)
async def command(request: Request, body: CommandBody, key: Key, visitor: Asked) -> dict[str, Any]:
    """Have a command obeyed; the same key again gives the same answer, and obeys nothing twice.

    403 for the role or the place, 409 when the cell refuses, 412 when it has changed since it was
    looked at, 503 when the daemon is away, 504 when nobody knows whether it was taken.
    """
    parts = request.app.state.parts
    name = body.command.request
    # Whoever wants the cell to stop is never told to wait.
    if name not in UNLIMITED:
        wait_s = parts.commands.wait_s(visitor.key)
        if wait_s:
            raise Problem(429, "commands", "too many commands").later(wait_s)
    if visitor.session is not None:
        # A command is what shows that somebody is there. Looking on does not, because a page goes
        # on asking for the view when its person has left.
        visitor.session.used_s = now_s()
    message = PageCommand(on_behalf=_on_behalf(visitor, body, key), command=body.command)
    try:
        answer = await parts.link.ask(message)
    except DaemonNotReached as fault:
        told = StopNotDelivered(fault.detail) if name in UNLIMITED else fault
        raise Problem(503, "daemon-away", str(told), fault=told.number).later(1) from fault
    except AnswerMissing as missing:
        detail = "no answer: the cell may have taken the command, or not"
        raise Problem(504, "unknown", detail) from missing
    who = message.on_behalf
    _log.info("command", who=who.person, panel=who.panel, cmd=name, answer=answer.answer)
    if isinstance(answer, Taken):
        return {"key": key, "command": name, "state": answer.state}
    if isinstance(answer, Refused):
        code = RejectCode(answer.code)
        status = _STATUS.get(code, 409)
        raise Problem(status, "refused", answer.text, reject_code=code, state=answer.state)
    assert isinstance(answer, Failed), "a command has no other answers"
    raise Problem(502, f"fault-{answer.number}", answer.text, fault=answer.number)


@router.get("/commands/{key}")
async def outcome(
    request: Request,
    key: Annotated[str, Path(pattern=KEY, description="Its `Idempotency-Key`.")],
    _visitor: Asked,
) -> CommandTold:
    """What became of a command, by its key: for whoever had 504, or another's answer.

    From the audit log, so it holds over restarts. 404 while nothing is on record: the cell has not
    taken it, or only just, and a Stop or Abort is obeyed before it is written down.
    """
    found = await request.app.state.parts.archive.ask(lambda store: store.audit_of_command(key))
    if not found:
        raise Problem(404, "command-unknown", "there is no record of a command with this key")
    return command_told(found[-1])


def _on_behalf(visitor: Visitor, body: CommandBody, key: str) -> OnBehalf:
    return OnBehalf(
        person=visitor.person or "nobody",
        role=visitor.role,
        panel=visitor.panel,
        reason=body.reason,
        decision=body.decision,
        key=key,
    )
