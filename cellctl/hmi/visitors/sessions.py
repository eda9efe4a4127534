"""Who has signed in, and for how long they may still operate."""

import hashlib
import secrets
from collections import OrderedDict
from dataclasses import dataclass

from cellctl.api.local_socket.messages import Role
from cellctl.clock import Monotonic, now_s

SESSIONS = 200
LIFE_S = 12 * 3600.0


@dataclass(slots=True)
class Session:
    """One sign-in of one person in one browser."""

    person: str
    role: Role
    begun_s: float
    used_s: float
    """When the person did something last. Looking on is nothing."""


class Sessions:
    """Kept in memory: after a restart of the page everybody signs in again."""

    def __init__(self, idle_s: float, *, clock: Monotonic = now_s) -> None:
        self._idle_s = idle_s
        self._now_s = clock
        self._sessions: OrderedDict[str, Session] = OrderedDict()

    def open(self, person: str, role: Role) -> str:
        """Sign in; the secret of the session, of which only a hash is kept."""
        secret = secrets.token_urlsafe(32)
        time_s = self._now_s()
        self._sessions[_key(secret)] = Session(person, role, time_s, time_s)
        while len(self._sessions) > SESSIONS:
            self._sessions.popitem(last=False)
        return secret

    def find(self, secret: str) -> Session | None:
        """The session; None when it was never opened, has ended or is older than a shift."""
        found = self._sessions.get(_key(secret)) if secret else None
        if found is not None and self._now_s() - found.begun_s > LIFE_S:
            self.close(secret)
            return None
        return found

    def close(self, secret: str) -> None:
        """Sign out. Idempotent."""
        self._sessions.pop(_key(secret), None)

    def role(self, session: Session) -> Role:
        """What the person may do now: only look on, when they have done nothing for long."""
        idle = self._now_s() - session.used_s > self._idle_s
        return "view" if idle else session.role


def _key(secret: str) -> str:
    return hashlib.sha256(secret.encode()).hexdigest()
