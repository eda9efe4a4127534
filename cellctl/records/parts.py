"""The parts of a run: that of the run's own serial number, and the one that it is joined to."""

from cellctl.records.entries import RunRecord

PARTS, MATE_SERIAL = "parts", "mate_serial"
"""Document and key under which a run names the second part, where somebody has named it."""


def mate_serial(record: RunRecord) -> str:
    """Serial number of the part that the part of the run is joined to; empty where unknown."""
    return str(record.document(PARTS).get(MATE_SERIAL, ""))
