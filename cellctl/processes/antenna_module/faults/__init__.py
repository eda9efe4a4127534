"""The faults of plugging an antenna module: its connector, the plan and the push, calibrations."""

from cellctl.processes.antenna_module.faults import calibration, connector, plugging

__all__ = ["calibration", "connector", "plugging"]
