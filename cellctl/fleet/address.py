"""Where the fleet database is, and the password for it, which stands in no file that is copied."""

import os
from pathlib import Path

from sqlalchemy import URL, make_url

from cellctl.config.cell import checked_url
from cellctl.errors.records.fleet import FleetNotNamed

PASSWORD = "CELLCTL_FLEET_PASSWORD"  # the name of a variable
"""Variable of the environment; without it and without a file libpq looks where it always does."""


def address(url: str, password_file: str = "") -> URL:
    """The whole address; printing it hides the password. Raises ``FleetNotNamed``."""
    try:
        found = make_url(checked_url(url)).set(drivername="postgresql+psycopg")
    except ValueError as error:
        raise FleetNotNamed(str(error)) from None
    password = _first_line(Path(password_file)) if password_file else os.environ.get(PASSWORD)
    return found.set(password=password) if password else found


def _first_line(file: Path) -> str:
    try:
        lines = file.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise FleetNotNamed(f"password file {file}: {error}") from error
    if not lines or not lines[0]:
        raise FleetNotNamed(f"password file {file} is empty")
    return lines[0]
