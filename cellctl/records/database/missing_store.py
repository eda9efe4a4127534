"""A folder without a run store, and where one is that may be meant."""

from pathlib import Path

from cellctl.errors.records.store import StoreUnavailable

_BELOW = "store"
"""The folder of the store below that of a demonstration."""


def missing_store(file: Path) -> StoreUnavailable:
    """The fault for a database that is not there."""
    below = file.parent / _BELOW / file.name
    meant = f"; did you mean {below.parent}?" if below.exists() else ""
    return StoreUnavailable(f"there is no {file}{meant}")
