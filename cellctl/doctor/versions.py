"""Which software there is, held against what this version was tested with."""

import platform
import re
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from cellctl.doctor.finding import Finding, doubtful, good
from cellctl.version import software

_LOCKED = re.compile(r"^([A-Za-z0-9._-]+)==([^\s;\\]+)(?:\s*;\s*(\S.*?))?\s*\\?$")


def version_findings(lock_file: Path) -> Iterator[Finding]:
    """Program, Python, kernel, and packages that differ from the lock file."""
    yield good("program", software())
    yield good("Python", platform.python_version())
    yield good("kernel", platform.release())
    if not lock_file.exists():
        return
    different = list(_different(lock_file.read_text(encoding="utf-8")))
    if different:
        remedy = f"pip install --require-hashes -r {lock_file}"
        yield doubtful("packages", f"not as tested: {', '.join(different)}", remedy)
    else:
        yield good("packages", "as in the lock file")


def _different(lock: str) -> Iterator[str]:
    for line in lock.splitlines():
        if not (found := _LOCKED.match(line)) or found[3]:
            continue  # one with a condition may rightly be away
        name, wanted = found[1], found[2]
        try:
            present = version(name)
        except PackageNotFoundError:
            yield f"{name} {wanted} is missing"
            continue
        if present != wanted:
            yield f"{name} {present} instead of {wanted}"
