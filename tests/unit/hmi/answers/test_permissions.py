"""What page and API say somebody may do is what the daemon's judge says of them."""

from typing import Any, get_args

import pytest

from cellctl.api.local_socket.messages import OnBehalf, Role
from cellctl.api.local_socket.page_desk import refusal
from cellctl.hmi.answers.permissions import REQUESTS, permissions, session_told
from cellctl.hmi.visitors.access import Visitor
from cellctl.packml.reject import RejectCode
from cellctl.translations import LANGUAGES

ALL_WELL = {name: {"code": 0, "reason": ""} for name in REQUESTS}
IN_THE_STATE = RejectCode.COMMAND_NOT_ALLOWED
NOTHING = {name: {"code": int(IN_THE_STATE), "reason": IN_THE_STATE.text} for name in REQUESTS}


def judged(name: str, role: Role, panel: str) -> RejectCode:
    return refusal(
        name, OnBehalf(person="anna", role=role, panel=panel, decision=3, key="key-0001"), 3
    )


@pytest.mark.parametrize("role", get_args(Role))
@pytest.mark.parametrize("panel", ["", "panel-1"])
@pytest.mark.parametrize("name", REQUESTS)
def test_role_and_place_are_judged_alike(role: Role, panel: str, name: str) -> None:
    visitor = Visitor("anna", role, panel, "key")
    code = judged(name, role, panel)
    own = session_told(visitor, "en").commands[name]
    assert own.code == code
    assert own.reason == (code.text if code else "")
    assert permissions(visitor, ALL_WELL, "en")[name].code == code
    # What is theirs may still be refused by the state of the cell; what is not theirs is so first.
    refused = permissions(visitor, NOTHING, "en")[name]
    assert (refused.code, refused.reason) == ((code or IN_THE_STATE), (code or IN_THE_STATE).text)


def test_what_a_command_needs_is_the_least_role_that_may_give_it() -> None:
    for name, told in session_told(Visitor("", "view", "", ""), "en").commands.items():
        allowed = [role for role in get_args(Role) if not judged(name, role, "panel-1")]
        # At a panel anybody may abort.
        assert told.needs == ("operate" if name == "abort" else allowed[0])


@pytest.mark.parametrize("language", LANGUAGES)
def test_reasons_are_in_the_language_of_whoever_asks(language: str) -> None:
    said: dict[str, Any] = permissions(Visitor("", "view", "", ""), ALL_WELL, language)
    english = RejectCode.ROLE_MISSING.text
    assert (said["start"].reason == english) == (language == "en")
