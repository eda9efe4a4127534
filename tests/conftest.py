"""How tests are shared out between workers."""

import pytest
from xdist.scheduler import LoadScopeScheduling


class CellsOneByOne(LoadScopeScheduling):
    """Tests of whole cells fill a processor each: one worker runs them all, one after the other.

    The others go out singly. (`--dist loadgroup` would do, but xdist 3.8 loses the groups with
    pytest 9.2, silently.)
    """

    def _split_scope(self, nodeid: str) -> str:
        return "cell" if nodeid.startswith("tests/cell/") else nodeid


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> CellsOneByOne:
    return CellsOneByOne(config, log)
