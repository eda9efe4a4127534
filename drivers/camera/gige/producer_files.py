"""Which producers are loaded."""

import os
from pathlib import Path

from drivers.camera.gige.config import Acquisition

PRODUCER_PATH = "GENICAM_GENTL64_PATH"


def producer_files(acquisition: Acquisition) -> tuple[Path, ...]:
    """Those of the settings, else those in the folders of GENICAM_GENTL64_PATH; none if empty."""
    if acquisition.producers:
        return acquisition.producers
    folders = filter(None, os.environ.get(PRODUCER_PATH, "").split(os.pathsep))
    return tuple(path for folder in folders for path in sorted(Path(folder).glob("*.cti")))
