from tests.unit.fleet.conftest import fleet, server

__all__ = ["fleet", "server"]
