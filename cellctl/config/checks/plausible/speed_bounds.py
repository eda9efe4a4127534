"""Bounds of speed that bound nothing."""

from collections.abc import Iterator, Set

from cellctl.config.cell import CellConfig
from cellctl.config.checks.protective_times import most_way_mm, times_alone_s
from cellctl.config.driver_settings import motion_bounds
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM

_KEY = "max_speed_mm_s"
"""Name of the bound in the settings of drivers (docs/writing-a-robot-driver.md)."""


def speed_bound_issues(cell: CellConfig, bad: Set[str]) -> Iterator[ConfigIssue]:
    """Speeds up to which a driver takes commands, and at which an arm alone would go too far.

    ``bad`` holds the paths of devices whose settings are wrong themselves.
    """
    for name, robot in cell.robots.items():
        if f"robots.{name}" in bad or _KEY not in robot.settings:
            continue
        speed_m_s = motion_bounds(robot).speed_m_s
        alone = max(times_alone_s(cell, name).items(), key=lambda item: item[1], default=None)
        if speed_m_s is None or alone is None:
            continue
        (key, time_s), way_mm = alone, most_way_mm(cell)
        most_mm_s = way_mm / time_s
        if speed_m_s / MM > most_mm_s * (1.0 + 1e-9):
            allowed = (
                f"at most {most_mm_s:.4g}: the driver takes commands up to it, and with {key} an "
                f"arm that is alone would go on for {speed_m_s / MM * time_s:.0f} mm of {way_mm:g}"
            )
            where = f"robots.{name}.settings.{_KEY}"
            yield ConfigIssue(where, f"{speed_m_s / MM:g}", allowed)
