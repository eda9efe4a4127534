"""Commands of persons at the operator page: who may bring them, which of them, and each once."""

import asyncio
import os
from collections import OrderedDict
from collections.abc import Awaitable, Callable, Mapping

from cellctl.api.local_socket.messages import (
    Answer,
    CommandRequest,
    Failed,
    OnBehalf,
    PageCommand,
    Refused,
    Role,
    Taken,
)
from cellctl.api.local_socket.users import Users
from cellctl.errors.local import NotThePage
from cellctl.packml.reject import RejectCode

TurnedDown = Callable[[CommandRequest, str, RejectCode, Mapping[str, str]], None]
"""Notes what a person was refused, with what the audit log is told besides."""
Obey = Callable[[CommandRequest, str, Mapping[str, str]], Awaitable[Taken | Refused]]
"""Submits a command of a person, with what the audit log is told besides."""

KEYS_KEPT = 1000
"""Answers that are remembered, for commands that come again. A browser repeats one within seconds,
so that hours of commands are more than enough."""
ROLES: tuple[Role, ...] = ("view", "operate", "maintain")
"""Roles in rising order of what they may do."""
NEEDS: Mapping[str, Role] = {"mode": "maintain", "procedure": "maintain"}
"""Role by request; all others need ``operate``."""
AT_A_PANEL = frozenset({"start", "reset", "unhold", "mode", "procedure"})
"""What may move the cell, or leads to it, needs somebody who sees the cell."""
ENDS_MOTION = frozenset({"stop", "abort"})


def refusal(request: str, on_behalf: OnBehalf, decision: int) -> RejectCode:
    """Why this person may not ask for it, here and now; NONE when they may.

    ``decision`` is the count of ``LiveView`` by now: whoever decided upon an older state might
    have decided otherwise. Stop and Abort are never too late.
    """
    code = not_theirs(request, on_behalf.role, on_behalf.panel)
    if code is not RejectCode.NONE:
        return code
    if request not in ENDS_MOTION and on_behalf.decision != decision:
        return RejectCode.SUPERSEDED
    return RejectCode.NONE


def not_theirs(request: str, role: Role, panel: str) -> RejectCode:
    """Why somebody with this role may not ask for it at this place; NONE when they may.

    ``panel`` is the name of the panel; empty for everywhere else.
    """
    abort_at_panel = request == "abort" and bool(panel)
    if ROLES.index(role) < ROLES.index(needed_role(request)) and not abort_at_panel:
        return RejectCode.ROLE_MISSING
    if request in AT_A_PANEL and not panel:
        return RejectCode.NOT_AT_A_PANEL
    return RejectCode.NONE


def needed_role(request: str) -> Role:
    """The least role that may ask for it."""
    return NEEDS.get(request, "operate")


class PageDesk:
    """Belongs to one event loop."""

    def __init__(
        self,
        page_user: str,
        users: Users,
        decision: Callable[[], int],
        obey: Obey,
        turned_down: TurnedDown,
    ) -> None:
        self._page_user = page_user
        self._users = users
        self._decision = decision
        self._obey = obey
        self._turned_down = turned_down
        self._answers: OrderedDict[str, tuple[PageCommand, asyncio.Future[Answer]]] = OrderedDict()

    async def handle(self, request: PageCommand, uid: int) -> Answer:
        """The answer to a command; the same one again when the command comes again.

        Raises ``NotThePage`` for a key that was used for another command, and for a user who is
        not the page's: everybody else speaks for themselves alone.
        """
        if uid != os.getuid() and self._users.name(uid) != self._page_user:
            raise NotThePage(f"user {self._users.name(uid)}")
        key = request.on_behalf.key
        known = self._answers.get(key)
        if known is not None:
            before, answer = known
            if _meant(before) != _meant(request):
                raise NotThePage(f"key {key} was used for another command")
            # Shielded: a browser that asks again and goes away must not cancel the answer for which
            # the first request still waits.
            return await asyncio.shield(answer)
        answer = asyncio.get_running_loop().create_future()
        # Before the command is carried out: the same command that comes meanwhile waits for this
        # answer, and is not given a second time.
        self._answers[key] = request, answer
        while len(self._answers) > KEYS_KEPT:
            self._answers.popitem(last=False)
        try:
            answer.set_result(await self._judged(request))
        finally:
            if not answer.done():  # a device broke: whoever asks again learns that it was begun
                answer.set_result(Failed(number=NotThePage.number, text="the command failed"))
        return answer.result()

    async def _judged(self, request: PageCommand) -> Answer:
        person = request.on_behalf
        name = request.command.request
        who = f"{person.person}@{person.panel}" if person.panel else person.person
        details = {"role": person.role, "key": person.key, "reason": person.reason}
        code = refusal(name, person, self._decision())
        if code is RejectCode.NONE:
            return await self._obey(request.command, who, details)
        # What the cell refuses it notes itself; this never comes so far.
        self._turned_down(request.command, who, code, details)
        return Refused(code=code, text=code.text, state="")


def _meant(request: PageCommand) -> tuple[str, CommandRequest]:
    return request.on_behalf.person, request.command
