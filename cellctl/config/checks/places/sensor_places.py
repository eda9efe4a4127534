"""Holds the place of a force sensor, and of what hangs on it, against the tool on the flange."""

from collections.abc import Iterator, Sequence

from cellctl.config.cell import CellConfig
from cellctl.config.checks.bounds.bound import Bound

_ALONG = 0.9
"""Share of a tool's length that lies along the axis of the flange where it is straight."""


def sensor_bounds(cell: CellConfig, sensor: str, flange_T_tool: Sequence[float]) -> Iterator[Bound]:
    """A sensor that is not between the flange and the tool; nothing for a tool to the side.

    ``flange_T_tool`` is in its written form, mm. Moments are carried from the sensor to the tool
    with this place, and the weight of what hangs on it.
    """
    if (reach_mm := straight_mm(flange_T_tool)) is None:
        return
    why = f"z of the sensor: it sits between the flange and its tool, whose z is {reach_mm:g}"
    along_mm = cell.force_sensors[sensor].flange_T_sensor[2]
    key = f"force_sensors.{sensor}.flange_T_sensor"
    yield Bound(key, along_mm, why, least=0.0, most=reach_mm)


def straight_mm(flange_T_tool: Sequence[float]) -> float | None:
    """How far the tool is before the flange; None where it points to a side."""
    x_mm, y_mm, z_mm = flange_T_tool[:3]
    length_mm = (x_mm**2 + y_mm**2 + z_mm**2) ** 0.5
    return z_mm if length_mm > 0.0 and z_mm >= _ALONG * length_mm else None
