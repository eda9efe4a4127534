"""Users and groups of the service, the page and whoever commands the cell from a terminal."""

from collections.abc import Iterator

from cellctl.config.cell import CellConfig
from cellctl.doctor.finding import Finding, bad, doubtful, good
from cellctl.doctor.pc import Pc
from cellctl.doctor.service import Service

_MAKE = "sudo systemd-sysusers"


def account_findings(pc: Pc, service: Service, cell: CellConfig | None) -> Iterator[Finding]:
    """Whether every user and group exists that unit and cell file name."""
    yield _user(pc, "user of the service", service.user)
    for group in service.groups:
        yield _group(pc, "group of the service", group)
    if cell is None:
        return
    if cell.local_api.group:
        yield _group(pc, "group of the operators", cell.local_api.group)
    page = cell.local_api.page_user
    if pc.user(page) is None:
        found = f"there is no user {page}: the operator page cannot say who asks"
        yield doubtful("user of the page", found, _MAKE)
    else:
        yield good("user of the page", page)


def _user(pc: Pc, subject: str, name: str) -> Finding:
    if pc.user(name) is None:
        return bad(subject, f"there is no user {name}", _MAKE)
    return good(subject, name)


def _group(pc: Pc, subject: str, name: str) -> Finding:
    if pc.group(name) is None:
        return bad(subject, f"there is no group {name}", f"{_MAKE}, or sudo groupadd {name}")
    return good(subject, name)
