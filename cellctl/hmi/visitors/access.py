"""Who asks, from where, and whether their browser was made to ask by somebody else."""

import ipaddress
from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Request, Security

from cellctl.api.local_socket.messages import Role
from cellctl.hmi.answers.document import BEARER, COOKIE, SESSION
from cellctl.hmi.problems import Problem
from cellctl.hmi.settings import LOOPBACK, PageSettings
from cellctl.hmi.visitors.hosts import host_name
from cellctl.hmi.visitors.people import People
from cellctl.hmi.visitors.sessions import Session, Sessions


@dataclass(frozen=True, slots=True)
class Visitor:
    """Whoever asks."""

    person: str
    """Empty for somebody who has not signed in."""
    role: Role
    panel: str
    """Name of the panel; empty for a page elsewhere."""
    key: str
    """Key of the session, the token or the address: what limits count by."""
    session: Session | None = None

    @property
    def idle(self) -> bool:
        """True for somebody who may only look on because they have done nothing for long."""
        return self.session is not None and self.role != self.session.role


class Gatekeeper:
    """Tells visitors apart. Belongs to one event loop."""

    def __init__(self, settings: PageSettings, people: People, sessions: Sessions) -> None:
        self._settings = settings
        self._people = people
        self._sessions = sessions

    def visitor(self, request: Request) -> Visitor:
        """Raises ``Problem`` 401 for somebody elsewhere who has not signed in."""
        panel = self.panel(request)
        bearer = request.headers.get("authorization", "")
        if bearer:
            program = self._people.program(bearer.removeprefix("Bearer "))
            if program is None:
                raise Problem(401, "token", "the token is unknown or has expired")
            # A program is at no panel, wherever it runs: nobody sees the cell there.
            return Visitor(program.name, program.role, "", f"token:{program.name}")
        secret = request.cookies.get(COOKIE, "")
        session = self._sessions.find(secret)
        if session is not None:
            role = self._sessions.role(session)
            return Visitor(session.person, role, panel, f"session:{secret}", session)
        if not panel:
            raise Problem(401, "sign-in", "sign in first")
        return Visitor("", "view", panel, f"panel:{panel}")

    def panel(self, request: Request) -> str:
        """Name of the panel that asks; empty for everybody else."""
        address = address_of(request)
        name = self._settings.panels.get(address, "")
        # What comes through a proxy on this PC has the loopback address, but asks for the name of
        # the proxy. It is no panel.
        asked_for = host_name(request.headers.get("host", ""))
        if name and _is_loopback(address) and asked_for not in LOOPBACK:
            return ""
        # A proxy on the panel itself would lend its place to whoever sits behind it.
        if name and request.headers.get("x-forwarded-for"):
            return ""
        return name


def require_own_page(request: Request) -> None:
    """Only our own page, or a program with a token, may ask for a change.

    Raises ``Problem`` 403 or 415. A browser sends cookies along whoever's page makes it ask.
    """
    if request.headers.get("content-type", "").split(";")[0] != "application/json":
        raise Problem(415, "media-type", "send application/json")
    # A browser does not send this header by itself, so no other page can have it sent.
    if request.headers.get("authorization"):
        return
    origin = request.headers.get("origin")
    same = request.headers.get("sec-fetch-site") == "same-origin"
    # Sec-Fetch-Site is missing on plain http; Origin comes with every POST and DELETE.
    if origin is not None:
        same = origin.partition("://")[2] == request.headers.get("host", "")
    if not same:
        raise Problem(403, "origin", "only this page may ask for that")


def address_of(request: Request) -> str:
    """Address of the client; empty when there is none."""
    return request.client.host if request.client else ""


def _is_loopback(address: str) -> bool:
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return False


def visitor(
    request: Request,
    _session: Annotated[object, Security(SESSION)],
    _token: Annotated[object, Security(BEARER)],
) -> Visitor:
    """For the routes: who asks."""
    # The two schemes tell the document of the API what the gatekeeper looks at, and nothing else.
    gatekeeper: Gatekeeper = request.app.state.parts.gatekeeper
    return gatekeeper.visitor(request)


Asked = Annotated[Visitor, Depends(visitor)]
OWN_PAGE = [Depends(require_own_page)]
"""Dependency of routes that change something. As a dependency it is asked before the body is
judged."""
