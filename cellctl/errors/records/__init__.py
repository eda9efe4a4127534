"""8xx: records, of one cell in its run store and of many in the fleet database."""

from cellctl.errors.records import fleet, store

__all__ = ["fleet", "store"]
