"""Sign in and out."""

from typing import Annotated

from fastapi import APIRouter, Request, Response
from pydantic import BaseModel, ConfigDict, Field

from cellctl import log
from cellctl.hmi.answers.document import COOKIE
from cellctl.hmi.answers.permissions import SessionTold, session_told
from cellctl.hmi.problems import Problem
from cellctl.hmi.visitors.access import OWN_PAGE, Asked, Visitor, address_of
from cellctl.hmi.words.languages import Language

router = APIRouter(tags=["session"])
_log = log.get(__name__)


class SignIn(BaseModel):
    """Name and PIN or password."""

    model_config = ConfigDict(extra="forbid", use_attribute_docstrings=True)

    name: Annotated[str, Field(max_length=32)]
    """As in the settings of the page."""
    pin: Annotated[str, Field(max_length=128)]
    """PIN or password."""


@router.get("/session")
async def who(visitor: Asked, language: Language) -> SessionTold:
    """Who asks, with which role, at which panel, and which commands are theirs to give."""
    return session_told(visitor, language)


@router.post("/session", dependencies=OWN_PAGE)
async def sign_in(
    request: Request, response: Response, body: SignIn, language: Language
) -> SessionTold:
    """Sign in; the answer sets a cookie that scripts cannot read.

    401 for a wrong name or PIN, 429 after five tries in a minute from one address. A program with a
    token does not sign in.
    """
    parts = request.app.state.parts
    address = address_of(request)
    # By the address and not by the name: otherwise anybody could lock a colleague out.
    wait_s = parts.sign_ins.wait_s(address)
    if wait_s:
        raise Problem(429, "sign-ins", "too many tries from here").later(wait_s)
    person = await parts.people.person(body.name, body.pin)
    if person is None:
        _log.warning("sign-in refused", name=body.name, address=address)
        raise Problem(401, "sign-in", "name or PIN is wrong")
    _log.info("signed in", person=person.name, role=person.role, address=address)
    secret = parts.sessions.open(person.name, person.role)
    response.set_cookie(COOKIE, secret, path="/", secure=True, httponly=True, samesite="strict")
    panel = parts.gatekeeper.panel(request)
    return session_told(Visitor(person.name, person.role, panel, ""), language)


@router.delete("/session", dependencies=OWN_PAGE)
async def sign_out(request: Request, response: Response, language: Language) -> SessionTold:
    """Sign out; also for somebody who is not signed in."""
    parts = request.app.state.parts
    parts.sessions.close(request.cookies.get(COOKIE, ""))
    response.delete_cookie(COOKIE, path="/", secure=True, httponly=True, samesite="strict")
    panel = parts.gatekeeper.panel(request)
    return session_told(Visitor("", "view", panel, ""), language)
