"""The service as systemd knows it: the unit that is installed, and its drop-ins."""

import shlex
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from cellctl.doctor.pc import Pc

UNIT = "/etc/systemd/system/cellctl.service"
PACKAGED_UNIT = "/usr/lib/systemd/system/cellctl.service"
LIMITS_DROP_IN = f"{UNIT}.d/cell.conf"
"""Where the commissioning guide puts what `cellctl service-limits` prints."""


@dataclass(frozen=True, slots=True)
class Service:
    """What the unit says of the daemon."""

    unit: str
    """Path of the unit's file."""
    settings: Mapping[str, Sequence[str]]
    """Values of each key of the unit in the order in which they stand."""

    def last(self, key: str, otherwise: str = "") -> str:
        """What counts of a key that has one value."""
        values = self.settings.get(key, ())
        return values[-1] if values else otherwise

    @property
    def user(self) -> str:
        """The daemon runs as this user."""
        return self.last("User", "root")

    @property
    def groups(self) -> tuple[str, ...]:
        """Its groups, the main one first."""
        others = " ".join(self.settings.get("SupplementaryGroups", ())).split()
        return (self.last("Group", self.user), *others)

    @property
    def command(self) -> tuple[str, ...]:
        """Program and arguments."""
        return tuple(shlex.split(self.last("ExecStart")))

    def option(self, name: str) -> str | None:
        """The value of an option of the command."""
        words = self.command
        return words[words.index(name) + 1] if name in words[:-1] else None


def installed_service(pc: Pc) -> Service | None:
    """The unit with its drop-ins; None when there is none."""
    # systemd takes the unit below /etc in place of the packaged one, and reads drop-ins after it
    # (man 5 systemd.unit).
    for unit in (UNIT, PACKAGED_UNIT):
        text = pc.read(unit)
        if text is None:
            continue
        settings: dict[str, list[str]] = defaultdict(list)
        _take(text, settings)
        for drop_in in pc.find(f"{UNIT}.d/*.conf"):
            _take(pc.read(drop_in) or "", settings)
        return Service(unit, settings)
    return None


def _take(text: str, settings: dict[str, list[str]]) -> None:
    for line in text.replace("\\\n", " ").splitlines():
        key, separator, value = line.strip().partition("=")
        if not separator or key.startswith(("#", ";", "[")):
            continue
        # An empty value takes back what was said before (man 7 systemd.syntax).
        if value.strip():
            settings[key.strip()].append(value.strip())
        else:
            settings[key.strip()].clear()


def hidden_by(service: Service, path: Path) -> str:
    """Which setting of the unit hides a path from the daemon; empty when none does."""
    homes = ("/home", "/root", "/run/user")
    if service.last("ProtectHome") in {"yes", "true", "1", "on", "tmpfs"} and any(
        path.is_relative_to(home) for home in homes
    ):
        return "ProtectHome"
    if service.last("PrivateTmp") in {"yes", "true", "1", "on"} and any(
        path.is_relative_to(folder) for folder in ("/tmp", "/var/tmp")
    ):
        return "PrivateTmp"
    return ""
