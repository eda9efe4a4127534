"""Results of procedures that were beyond their limits: where somebody looks for them later.

The run store keeps calibrations that something uses. Of one that was put aside its audit log says
when, of which run, why, and where the file lies.
"""

from collections.abc import Sequence

from cellctl.records.entries import AuditEntry

REJECTED = "calibration rejected"
"""Action of the audit log; the detail has ``item``, ``run`` and ``reason``."""


def rejected(audit: Sequence[AuditEntry], kind: str) -> tuple[AuditEntry, ...]:
    """Rejected results of one kind of calibration, oldest first; ``audit`` is the whole log."""
    return tuple(one for one in audit if one.action == REJECTED and one.detail.get("item") == kind)


def rejected_kinds(audit: Sequence[AuditEntry]) -> set[str]:
    """Names of all kinds of which a result was rejected."""
    return {str(one.detail.get("item")) for one in audit if one.action == REJECTED}
