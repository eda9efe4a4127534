"""How tests are marked and shared out between workers, and what slow machines are allowed."""

import atexit
import gc
import logging
from collections.abc import Generator, Iterator
from pathlib import Path

import hypothesis
import pytest
import structlog
from xdist.scheduler import LoadScopeScheduling

from cellctl import log

pytest_plugins = ["tests.closing_servers", "tests.failed_again", "tests.machine_pauses"]

_WHOLE_CELLS = Path(__file__).parent / "cell"
_WHOLE_FILES = (
    "tests/contracts/test_writing_a_",  # packages that are installed for it
    "tests/programs/test_writing_a_process.py",
    "tests/test_house_style.py",  # all files, parsed
    "tests/unit/benchmarks/",  # runs whose figures several tests read
    "tests/unit/calibration/",  # rendered boards, solved cameras
    "tests/unit/cli/",  # rendered images, fake cells that stand for all tests of a file
    "tests/unit/fakes/scenes/",
    "tests/unit/fakes/test_imperfections.py",  # what is seen without any
    "tests/unit/planning/views/",  # a measurement planned
    "tests/unit/processes/antenna_module/",  # rendered connectors, what was taught
    "tests/unit/processes/deck_to_frame/mating/test_mate.py",  # a mating
    "tests/unit/processes/deck_to_frame/report/test_report.py",  # drawings, a report
    "tests/unit/processes/deck_to_frame/test_shipped_calibration.py",
    "tests/unit/records/database/",  # sealed and migrated stores
    "tests/unit/records/report/test_pdf.py",  # a report
    "tests/unit/vision/",  # rendered images
)
"""Files whose tests share what takes seconds to make; each worker would make it for itself."""
_WHOLE_FOLDERS = (
    "tests/unit/fleet/",  # a database server
    "tests/unit/hmi/page/",  # one browser
)
"""Folders whose files share it among them."""

# Hypothesis fails an example that lasts above 200 ms. On a busy machine that happens to correct
# code; pytest-timeout is there for code that hangs. The same examples in every run: a commit that
# passed must not fail on another machine. New ones are looked for by `make test-explore`.
hypothesis.settings.register_profile("same-examples", deadline=None, derandomize=True)
hypothesis.settings.register_profile("explore", deadline=None, max_examples=1000)
hypothesis.settings.load_profile("same-examples")


@pytest.fixture
def restored_logging() -> Iterator[None]:
    """Logging is as it was when the test has ended."""
    root = logging.getLogger()
    handlers, level = root.handlers[:], root.level
    yield
    root.handlers[:], root.level = handlers, level
    structlog.reset_defaults()
    log.always(dict)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """All of `tests/cell` is marked: `make test` runs it alone, after everything else."""
    for item in items:
        if _WHOLE_CELLS in item.path.parents:
            item.add_marker("cell")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """While tests are collected nearly everything that is made stays: to look through it again and
    again finds nothing."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()


def pytest_collection_finish(session: pytest.Session) -> None:
    """Everything that is there now stays to the end: the garbage collector need not go through it.

    Thousands of tests and their modules make it hold the program for half a second and more each
    time, in which no event loop takes a turn and a driver under test loses its connection.
    """
    gc.collect()
    gc.freeze()
    # What the tests themselves make is looked through less often: it was a twentieth of their time.
    gc.set_threshold(20_000, 10, 10)


# Libraries in C++ that look for leaks at the end would take what is frozen for one. Not earlier:
# pytest itself collects garbage after the last test.
atexit.register(gc.unfreeze)


class CellsOneByOne(LoadScopeScheduling):  # type: ignore[misc]  # xdist has no types
    """Tests of whole cells fill a processor each: one worker runs them all, one after the other.

    This matters when pytest is called by hand with several workers; `make test` gives them one.
    Files whose tests share something go out whole, the others test by test, so that no worker is
    left with a long file at the end. (`--dist loadgroup` would do, but xdist 3.8 loses the groups
    with pytest 9.2, silently.)
    """

    def _split_scope(self, nodeid: str) -> str:
        if nodeid.startswith("tests/cell/"):
            return "cell"
        for folder in _WHOLE_FOLDERS:
            if nodeid.startswith(folder):
                return folder
        whole = nodeid.startswith(_WHOLE_FILES)
        return nodeid.split("::", maxsplit=1)[0] if whole else nodeid


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> CellsOneByOne:
    return CellsOneByOne(config, log)
