"""Whether the service's user can start the program: an interpreter in a home directory ends in a
bare ``203/EXEC`` of systemd."""

import os
import stat
from collections.abc import Iterator
from pathlib import Path

from cellctl.doctor.finding import Finding, bad, doubtful, good
from cellctl.doctor.pc import Pc
from cellctl.doctor.service import UNIT, Service, hidden_by

_AGAIN = "sudo make install PYTHON=/usr/bin/python3"


def unit_findings(pc: Pc, service: Service | None, shipped: Path) -> Iterator[Finding]:
    """Whether the unit is there, is the one of this version, and starts with the PC."""
    if service is None:
        yield bad("unit", f"there is no {UNIT}", "sudo make install")
        return
    if _settings(pc.read(service.unit) or "") == _settings(shipped.read_text(encoding="utf-8")):
        yield good("unit", f"{service.unit} is that of this version")
    else:
        remedy = f"compare it with {shipped}; changes of this cell belong into a drop-in"
        yield doubtful("unit", f"{service.unit} is not that of this version", remedy)
    if list(pc.find("/etc/systemd/system/*.wants/cellctl.service")):
        yield good("start with the PC", "enabled")
    else:
        yield doubtful("start with the PC", "not enabled", "sudo systemctl enable cellctl")


def program_findings(pc: Pc, service: Service) -> Iterator[Finding]:
    """Whether program and interpreter are there, and the service's user reaches both."""
    program = Path(service.command[0]) if service.command else Path("/")
    if not pc.path(program).is_file():
        yield bad("program", f"the unit starts {program}, which does not exist", _AGAIN)
        return
    for subject, path in (("program", program), ("interpreter", _interpreter(pc, program))):
        yield _reached(pc, service, subject, path)


def _interpreter(pc: Pc, program: Path) -> Path:
    """What the first line of the program names, with all links followed."""
    first = (pc.read(program) or "").splitlines()[:1]
    if not first or not first[0].startswith("#!"):
        return program
    named = Path(first[0].removeprefix("#!").split()[0])
    return _followed(pc, named)


def _followed(pc: Pc, path: Path) -> Path:
    """The end of a chain of links, as the PC below ``root`` has them."""
    for _ in range(40):  # as many as Linux follows
        place = pc.path(path)
        if not place.is_symlink():
            break
        path = Path(os.path.normpath(path.parent / place.readlink()))
    return path


def _reached(pc: Pc, service: Service, subject: str, path: Path) -> Finding:
    hidden = hidden_by(service, path)
    if hidden:
        return bad(subject, f"{path} is hidden from the service by {hidden} of the unit", _AGAIN)
    if not pc.path(path).exists():
        return bad(subject, f"{path} does not exist", _AGAIN)
    # From the root on, because only the first folder that is closed says what hinders.
    for folder in reversed(path.parents):
        if not _mode(pc, folder) & stat.S_IXOTH:
            return bad(
                subject, f"{service.user} may not enter {folder}", f"sudo chmod o+x {folder}"
            )
    readable_program = stat.S_IROTH | stat.S_IXOTH
    if _mode(pc, path) & readable_program != readable_program:
        return bad(subject, f"{service.user} may not run {path}", f"sudo chmod o+rx {path}")
    return good(subject, f"{path}, which {service.user} can run")


def _mode(pc: Pc, path: Path) -> int:
    return pc.path(path).stat().st_mode


def _settings(text: str) -> list[str]:
    """Lines that say something; where the program lies is the PC's own matter."""
    lines = (line.strip() for line in text.splitlines())
    return [line for line in lines if line and not line.startswith(("#", "ExecStart="))]
