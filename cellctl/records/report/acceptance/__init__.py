"""The first page of a report: what was required and found, of which parts, by whom."""
