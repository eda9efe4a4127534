"""The operator page of a demonstration: its settings, with a PIN for this time only."""

import base64
import hashlib
import json
import secrets
from dataclasses import dataclass
from pathlib import Path

PEOPLE = {"operator": "operate", "engineer": "maintain"}
"""Who may sign in, and their roles."""
_N, _R, _P = 2**15, 8, 1
"""Cost figures of scrypt, those of the operator page: a secret does not carry them, and with others
no PIN would fit."""


@dataclass(frozen=True, slots=True)
class DemoPage:
    """What the user needs to know of it."""

    url: str
    pin: str

    @property
    def words(self) -> str:
        """A line for the user."""
        return f"operator page: {self.url}  (sign in as {' or '.join(PEOPLE)}, PIN {self.pin})"


def write_settings(folder: Path) -> tuple[Path, str]:
    """Settings of the page of a daemon whose store is in this folder; the file and the PIN."""
    pin = f"{secrets.randbelow(10**6):06d}"
    store = folder.absolute() / "store"
    lines = [
        f"socket = {_quoted(str(store / 'cellctl.sock'))}",
        f"data_dir = {_quoted(str(store))}",
        "port = 0",
    ]
    secret = _secret(pin)
    for name, role in PEOPLE.items():
        lines += ["", "[[people]]", f'name = "{name}"', f'role = "{role}"', f'secret = "{secret}"']
    file = folder / "page.toml"
    file.touch(mode=0o600)
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return file, pin


def _secret(pin: str) -> str:
    salt = secrets.token_bytes(16)
    found = hashlib.scrypt(
        pin.encode(), salt=salt, n=_N, r=_R, p=_P, maxmem=256 * _N * _R, dklen=32
    )
    return "scrypt$" + "$".join(base64.b64encode(part).decode() for part in (salt, found))


def _quoted(text: str) -> str:
    return json.dumps(text)  # a basic string of TOML is one of JSON
