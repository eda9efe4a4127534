"""Which producers are loaded."""

import os
from pathlib import Path

PRODUCER_PATH = "GENICAM_GENTL64_PATH"


def producer_files(named: tuple[Path, ...]) -> tuple[Path, ...]:
    """Those that are named, else those in the folders of GENICAM_GENTL64_PATH; none if empty."""
    if named:
        return named
    folders = filter(None, os.environ.get(PRODUCER_PATH, "").split(os.pathsep))
    return tuple(path for folder in folders for path in sorted(Path(folder).glob("*.cti")))
