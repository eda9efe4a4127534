"""The settings of the operator page: a TOML file, without which the page only shows."""

import tomllib
from datetime import date
from pathlib import Path
from typing import Annotated, Self
from urllib.parse import urlsplit

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from cellctl.api.local_socket.messages import Role
from cellctl.errors.local import PageSettingsWrong
from cellctl.hmi.notifying.events import Event
from cellctl.records.files.delivery_file import FOLDER

Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9._-]{1,32}$")]
LOOPBACK = frozenset({"127.0.0.1", "::1", "localhost"})


class SettingsTable(BaseModel):
    """Strict, so that a misspelt key is no silent default."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Person(SettingsTable):
    """Who may sign in."""

    name: Name
    role: Role
    secret: str
    """As `cellctl-hmi secret` prints it."""


class Token(SettingsTable):
    """A program that asks the API."""

    name: Name
    role: Role
    sha256: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
    """Of the token."""
    expires: date
    """The last day on which it is accepted, UTC."""


class Receiver(SettingsTable):
    """Who is told what happens: a server by an HTTPS request, or a program that is started."""

    url: str = ""
    headers: dict[str, str] = Field(default_factory=dict)
    """Of the request, such as ``Authorization``."""
    program: tuple[str, ...] = ()
    """Command and arguments, without a shell; the message comes on its input."""
    on: Annotated[tuple[Event, ...], Field(min_length=1)] = tuple(Event)

    @model_validator(mode="after")
    def _is_one_of_both(self) -> Self:
        if bool(self.url) == bool(self.program):
            raise ValueError("give either url or program")
        if self.url:
            parts = urlsplit(self.url)
            # What goes beyond this PC names parts and orders, and may carry a secret.
            if parts.scheme != "https" and not (
                parts.scheme == "http" and parts.hostname in LOOPBACK
            ):
                raise ValueError("url: https:// (http:// on this PC alone)")
        return self


class PageSettings(SettingsTable):
    """Everything the page's process needs to know."""

    socket: str = "/run/cellctl/cellctl.sock"
    """The daemon's socket."""
    data_dir: str = "/var/lib/cellctl"
    """The run store, which is only read."""
    forwarder_dir: str = str(FOLDER)
    """Where a forwarder of records tells how the delivery goes."""
    host: str = "127.0.0.1"
    port: Annotated[int, Field(ge=0, le=65535)] = 8080
    hosts: tuple[str, ...] = ()
    """Names under which a proxy serves the page; this PC's own loopback names always are."""
    panels: dict[str, Name] = Field(default_factory=lambda: {"127.0.0.1": "panel-1"})
    """Name of the panel by its address: only there may somebody start what moves the cell."""
    idle_s: Annotated[float, Field(ge=30, le=3600)] = 600.0
    """A session that does nothing for this long only shows."""
    people: tuple[Person, ...] = ()
    tokens: tuple[Token, ...] = ()
    notify: tuple[Receiver, ...] = ()


def load_settings(path: Path) -> PageSettings:
    """Read the file; raises ``PageSettingsWrong``."""
    try:
        return PageSettings.model_validate(tomllib.loads(path.read_text(encoding="utf-8")))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise PageSettingsWrong(f"{path}: {error}") from error
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False, include_input=False)[0]
        place = ".".join(str(part) for part in first["loc"])
        raise PageSettingsWrong(f"{path}: {place}: {first['msg']}") from error
