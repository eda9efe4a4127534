from tests.unit.daemon_fixtures import bench, rig

__all__ = ["bench", "rig"]
