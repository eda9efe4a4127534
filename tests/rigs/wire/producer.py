"""The fake GenTL producer of all tests of a run."""

import fcntl
import os
from pathlib import Path

import pytest

from fakes.gentl.build import NAME, build_producer


def built_once(folders: pytest.TempPathFactory) -> Path:
    """The producer, compiled by whichever worker of this run needs it first."""
    own = folders.getbasetemp()
    # The folders of workers lie in that of their run.
    run = own.parent if "PYTEST_XDIST_WORKER" in os.environ else own
    folder = run / "producer"
    with (run / "producer.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (folder / NAME).exists():
            folder.mkdir(exist_ok=True)
            build_producer(folder)
    return folder / NAME
