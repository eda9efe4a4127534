"""Which software this is: the version of the package, and the revision of a checkout."""

import os
import subprocess
from functools import cache
from pathlib import Path

from cellctl import __version__

ROOT = Path(__file__).parents[1]
RELEASE = "RELEASE"
"""File in which `make install` keeps the revision of the tree that it was made from."""
_TIMEOUT_S = 5.0


@cache
def software() -> str:
    """``cellctl 0.1.0 (1a2b3c4d5e6f)``, with ``-dirty`` where files differ from the revision.

    The same as long as the process lives. Blocks while git is asked, once; without an installed
    release, a checkout or git there is no revision.
    """
    revision = _revision(ROOT)
    return f"cellctl {__version__} ({revision})" if revision else f"cellctl {__version__}"


def _revision(root: Path) -> str:
    if (root / RELEASE).is_file():
        return (root / RELEASE).read_text(encoding="utf-8").strip()
    if not (root / ".git").exists():
        return ""  # installed as a package: a repository around it would be another one
    # The daemon's user does not own the checkout; it only reads.
    command = ["git", "-c", f"safe.directory={root}", "-C", str(root)]
    try:
        told = subprocess.run(
            [*command, "describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"],
            capture_output=True,
            text=True,
            timeout=_TIMEOUT_S,
            check=True,
            env=os.environ | {"GIT_OPTIONAL_LOCKS": "0"},
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return told.stdout.strip()
