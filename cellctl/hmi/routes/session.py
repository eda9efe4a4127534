"""Sign in and out."""

from typing import Annotated, Any

from fastapi import APIRouter, Request, Response
from pydantic import BaseModel, ConfigDict, Field

from cellctl import log
from cellctl.api.local_socket.messages import Role
from cellctl.hmi.access import COOKIE, OWN_PAGE, Asked, address_of
from cellctl.hmi.problems import Problem

router = APIRouter(tags=["session"])
_log = log.get(__name__)


class SignIn(BaseModel):
    """Name and PIN or password."""

    model_config = ConfigDict(extra="forbid")

    name: Annotated[str, Field(max_length=32)]
    pin: Annotated[str, Field(max_length=128)]


@router.get("/session")
async def who(visitor: Asked) -> dict[str, Any]:
    """Who asks, with which role, at which panel, and whether they were idle for too long."""
    return _answer(visitor.person, visitor.role, visitor.panel, idle=visitor.idle)


@router.post("/session", dependencies=OWN_PAGE)
async def sign_in(request: Request, response: Response, body: SignIn) -> dict[str, Any]:
    """Sign in; the answer sets a cookie that scripts cannot read."""
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
    return _answer(person.name, person.role, parts.gatekeeper.panel(request))


@router.delete("/session", dependencies=OWN_PAGE)
async def sign_out(request: Request, response: Response) -> dict[str, Any]:
    """Sign out; also for somebody who is not signed in."""
    parts = request.app.state.parts
    parts.sessions.close(request.cookies.get(COOKIE, ""))
    response.delete_cookie(COOKIE, path="/", secure=True, httponly=True, samesite="strict")
    return _answer("", "view", parts.gatekeeper.panel(request))


def _answer(person: str, role: Role, panel: str, *, idle: bool = False) -> dict[str, Any]:
    return {"person": person, "role": role, "panel": panel, "idle": idle}
