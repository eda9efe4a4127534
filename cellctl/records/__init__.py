"""What the cell records: the run store, its files, recordings of force, and the report."""

from cellctl.records.entries import RunRecord, RunResult
from cellctl.records.store import RunStore

__all__ = ["RunRecord", "RunResult", "RunStore"]
