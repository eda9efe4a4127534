"""What whoever asks may have done: by role and place, and by what the cell takes now."""

from collections.abc import Mapping
from typing import Any

from cellctl.api.local_socket.messages import Role
from cellctl.api.local_socket.page_desk import needed_role, not_theirs
from cellctl.hmi.answers.form import Form
from cellctl.hmi.visitors.access import Visitor
from cellctl.hmi.words.page_words import refusal
from cellctl.packml.reject import RejectCode

REQUESTS = (
    "start", "procedure", "reset", "hold", "unhold", "clear", "stop", "abort", "mode",
    "acknowledge",
)  # fmt: skip


class Permission(Form):
    """Whether a command would be taken."""

    code: int
    """0 if it would, else the reject code."""
    reason: str
    """Why not; empty if it would."""


class OwnPermission(Permission):
    """Whether a person or program may give a command at all, whatever the state of the cell."""

    needs: Role
    """Role that the command needs."""


class SessionTold(Form):
    """Who asks, and what they may do."""

    person: str
    """Empty for somebody who has not signed in."""
    role: Role
    """`view` also for somebody who has been idle for too long."""
    panel: str
    """Name of the panel; empty for everywhere else."""
    idle: bool
    commands: dict[str, OwnPermission]
    """By name of the request, whatever the state of the cell; `/permitted` has that too."""


def session_told(visitor: Visitor, language: str) -> SessionTold:
    """The visitor, with what role and place allow."""
    commands = {
        name: OwnPermission(
            **_told(not_theirs(name, visitor.role, visitor.panel), language),
            needs=needed_role(name),
        )
        for name in REQUESTS
    }
    return SessionTold(
        person=visitor.person,
        role=visitor.role,
        panel=visitor.panel,
        idle=visitor.idle,
        commands=commands,
    )


def permissions(
    visitor: Visitor, said: Mapping[str, Mapping[str, Any]], language: str
) -> dict[str, Permission]:
    """By name of the request; ``said`` is what the daemon says of everybody, in English."""
    told = {}
    for name, one in said.items():
        code = not_theirs(name, visitor.role, visitor.panel)
        # What is not theirs is not theirs in any state: that reason goes first, as at the daemon.
        if code is RejectCode.NONE:
            words = refusal(one["code"], one["reason"], language)
            told[name] = Permission(code=one["code"], reason=words)
        else:
            told[name] = Permission(**_told(code, language))
    return told


def _told(code: RejectCode, language: str) -> dict[str, Any]:
    return {"code": int(code), "reason": refusal(code, code.text, language) if code else ""}
