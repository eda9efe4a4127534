"""What became of a command, as the audit log has it."""

from typing import Literal

from cellctl.hmi.answers.form import Form, Time
from cellctl.records.entries import AuditEntry


class CommandTold(Form):
    """A command of a person or a program that the cell has taken or refused."""

    key: str
    """The `Idempotency-Key` that it came with."""
    command: str
    """Such as `reset`; `set` for a mode or an acknowledgement."""
    outcome: Literal["taken", "refused"]
    refused: str
    """Why; empty for one that was taken."""
    who: str
    """Such as `page:anna@panel-1`."""
    role: str
    reason: str
    """In the person's words; empty where nobody gave one."""
    time: Time


def command_told(entry: AuditEntry) -> CommandTold:
    """The command of an entry that was made for the page."""
    detail = entry.detail
    refused = str(detail.get("refused", ""))
    return CommandTold(
        key=str(detail.get("key", "")),
        command=entry.action,
        outcome="refused" if refused else "taken",
        refused=refused,
        who=entry.actor,
        role=str(detail.get("role", "")),
        reason=str(detail.get("reason", "")),
        time=entry.time,
    )
