"""How tests are shared out between workers."""

import pytest
from xdist.scheduler import LoadScopeScheduling

_SHARED_IMAGES = ("tests/unit/vision/", "tests/unit/calibration/")


class CellsOneByOne(LoadScopeScheduling):
    """Tests of whole cells fill a processor each: one worker runs them all, one after the other.

    Files whose tests share rendered images go out whole, so that these are made once; the others
    singly. (`--dist loadgroup` would do, but xdist 3.8 loses the groups with pytest 9.2, silently.)
    """

    def _split_scope(self, nodeid: str) -> str:
        if nodeid.startswith("tests/cell/"):
            return "cell"
        return nodeid.split("::", maxsplit=1)[0] if nodeid.startswith(_SHARED_IMAGES) else nodeid


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> CellsOneByOne:
    return CellsOneByOne(config, log)
