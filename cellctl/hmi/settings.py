"""The settings of the operator page: a TOML file, without which the page only shows."""

import tomllib
from datetime import date
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from cellctl.api.local_socket.messages import Role
from cellctl.errors.local import PageSettingsWrong

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


class PageSettings(SettingsTable):
    """Everything the page's process needs to know."""

    socket: str = "/run/cellctl/cellctl.sock"
    """The daemon's socket."""
    data_dir: str = "/var/lib/cellctl"
    """The run store, which is only read."""
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
