"""The report of a run for people: HTML with figures and pictures."""

from cellctl.records.report.export import export_run

__all__ = ["export_run"]
