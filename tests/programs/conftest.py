"""Files and ports for programs of a test's own, as for the tests of whole cells."""

from tests.cell.conftest import own

__all__ = ["own"]
