"""What the cell records: the run store, its files, recordings of force, and the report."""

from typing import TYPE_CHECKING

from cellctl.records.entries import RunRecord, RunResult

if TYPE_CHECKING:
    from cellctl.records.store import RunStore

__all__ = ["RunRecord", "RunResult", "RunStore"]


def __getattr__(name: str) -> object:
    # The store brings the whole database layer, which whoever needs the entries alone, as a cell
    # file's check does, should not wait for.
    if name != "RunStore":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from cellctl.records.store import RunStore

    return RunStore
