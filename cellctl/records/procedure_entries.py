"""Entries of the audit log that a procedure makes, beside the command that began it.

The run store keeps calibrations that something uses. Of a result that was put aside because it was
beyond its limits, its audit log says when, of which run, why, and where the file lies.
"""

from collections.abc import Sequence

from cellctl.records.entries import AuditEntry

CALIBRATION_STORED = "calibration stored"
CALIBRATION_REJECTED = "calibration rejected"
"""The detail has ``item``, ``run`` and ``reason``."""
PROCEDURE_ENDED = "procedure ended"
MADE_BY_PROCEDURES = frozenset({CALIBRATION_STORED, CALIBRATION_REJECTED, PROCEDURE_ENDED})
"""No commands, though they name whose command led to them."""


def rejected(audit: Sequence[AuditEntry], kind: str) -> tuple[AuditEntry, ...]:
    """Rejected results of one kind of calibration, oldest first; ``audit`` is the whole log."""
    return tuple(one for one in audit if _is_rejection(one) and one.detail.get("item") == kind)


def rejected_kinds(audit: Sequence[AuditEntry]) -> set[str]:
    """Names of all kinds of which a result was rejected."""
    return {str(one.detail.get("item")) for one in audit if _is_rejection(one)}


def _is_rejection(entry: AuditEntry) -> bool:
    return entry.action == CALIBRATION_REJECTED
