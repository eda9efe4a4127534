"""Figures of a run as SVG, drawn without a display and without global state."""

from cellctl.records.plots.force import force_by_time, force_by_travel
from cellctl.records.plots.gauge import plug_gauges
from cellctl.records.plots.iterations import errors_by_iteration

__all__ = ["errors_by_iteration", "force_by_time", "force_by_travel", "plug_gauges"]
