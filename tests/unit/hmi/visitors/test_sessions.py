"""For how long somebody who has signed in may operate."""

from cellctl.hmi.visitors.access import Visitor
from cellctl.hmi.visitors.sessions import LIFE_S, Sessions


def test_whoever_does_nothing_for_long_only_looks_on_until_the_session_ends() -> None:
    time_s = [100.0]
    sessions = Sessions(600.0, clock=lambda: time_s[0])
    secret = sessions.open("anna", "operate")
    session = sessions.find(secret)
    assert session is not None

    def idle() -> bool:
        return Visitor("anna", sessions.role(session), "panel-1", "key", session).idle

    assert not idle()
    time_s[0] += 601.0
    assert idle()
    assert not Visitor("", "view", "panel-1", "key").idle, "nobody has signed in there"
    session.used_s = time_s[0]
    assert not idle()
    time_s[0] += LIFE_S
    assert sessions.find(secret) is None
