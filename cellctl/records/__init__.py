"""Run store, files, recordings, report."""

from cellctl.records.entries import RunRecord, RunResult
from cellctl.records.store import RunStore

__all__ = ["RunRecord", "RunResult", "RunStore"]
