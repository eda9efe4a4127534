"""Files and ports for programs of a test's own, as for the tests of whole cells."""

from tests.cell.conftest import own
from tests.guides.weighing import installed, small, written

__all__ = ["installed", "own", "small", "written"]
