"""What runs say of their parts and devices: names of documents that several packages know.

The parts of a run are that of its own serial number, and the one that it is joined to.
"""

from cellctl.records.entries import RunRecord

PARTS, MATE_SERIAL = "parts", "mate_serial"
"""Document and key under which a run names the second part, where somebody has named it."""
TOLD = "devices.told"
"""Document with what robots and force sensors have said of themselves: texts by name."""
RUNS_OF_A_PART = 100
"""Newest runs with a serial number that are looked at. A part is not begun a hundred times: the
bound only keeps a number that stands for "unknown" from having all its runs read."""


def mate_serial(record: RunRecord) -> str:
    """Serial number of the part that the part of the run is joined to; empty where unknown."""
    return str(record.document(PARTS).get(MATE_SERIAL, ""))
