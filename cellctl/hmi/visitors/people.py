"""Secrets of persons and programs: stored so that the file does not reveal them."""

import asyncio
import base64
import hashlib
import hmac
import secrets
from collections.abc import Sequence
from datetime import UTC, datetime

from cellctl.hmi.settings import Person, Token

_N, _R, _P = 2**15, 8, 1
_MEMORY = 128 * _N * _R * 2
_AT_ONCE = 2


def secret_of(pin: str) -> str:
    """What the settings keep of a PIN or password: salt and scrypt hash (RFC 7914)."""
    salt = secrets.token_bytes(16)
    return _kept(salt, _hashed(pin, salt))


def _kept(*parts: bytes) -> str:
    return "scrypt$" + "$".join(base64.b64encode(part).decode() for part in parts)


def _hashed(pin: str, salt: bytes) -> bytes:
    return hashlib.scrypt(pin.encode(), salt=salt, n=_N, r=_R, p=_P, maxmem=_MEMORY, dklen=32)


def matches(pin: str, secret: str) -> bool:
    """Whether the PIN is the one of the secret; False for a secret that is none."""
    kind, _, rest = secret.partition("$")
    salt, _, wanted = rest.partition("$")
    try:
        parts = [base64.b64decode(part, validate=True) for part in (salt, wanted)]
    except ValueError:
        return False
    return kind == "scrypt" and hmac.compare_digest(_hashed(pin, parts[0]), parts[1])


class People:
    """Those of the settings. Belongs to one event loop."""

    def __init__(self, people: Sequence[Person], tokens: Sequence[Token]) -> None:
        self._people = {person.name: person for person in people}
        self._tokens = tokens
        self._working = asyncio.Semaphore(_AT_ONCE)
        # Compared with for a name that nobody has, so that the time of the answer tells no names.
        # No PIN has this hash; to compute one would keep the page from its start.
        self._nobody = _kept(secrets.token_bytes(16), secrets.token_bytes(32))

    async def person(self, name: str, pin: str) -> Person | None:
        """Whoever has this name and this PIN."""
        found = self._people.get(name)
        secret = self._nobody if found is None else found.secret
        # In a thread, because the hash is slow on purpose; few at once, because it needs memory.
        async with self._working:
            right = await asyncio.to_thread(matches, pin, secret)
        return found if right else None

    def program(self, token: str) -> Token | None:
        """The program with this token, if it has not expired."""
        found = hashlib.sha256(token.encode()).hexdigest()
        today = datetime.now(UTC).date()
        return next(
            (
                one
                for one in self._tokens
                if hmac.compare_digest(one.sha256, found) and today <= one.expires
            ),
            None,
        )
