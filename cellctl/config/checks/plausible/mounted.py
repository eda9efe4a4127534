"""What is mounted on flanges: too far away, turned back to the arm, or lying on its side."""

import math
from collections.abc import Iterator

import numpy as np

from cellctl.config.cell import CellConfig
from cellctl.config.devices import ForceSensorConfig
from cellctl.config.document.leaves import leaves
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import pose_from_xyzabc

_FARTHEST_MM = 3000.0
"""Half of the longest part of a cell and a fixture, with room to spare."""
_BACK = -0.2
"""Cosine between optical axis and flange axis: a camera that looks across the flange is near zero,
one that is turned half round near -1."""
_ALONG = 0.9
"""Least cosine between the axes of a force sensor and its flange, either way: a disc between flange
and gripper."""

_FLAT_DEG = 2.0
"""Flanges are machined flat to far less."""


def mounted_issues(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Poses on a flange that are farther from it than any tool, cameras that see the arm, force
    sensors across the flange."""
    far: set[str] = set()
    for key, value in leaves(cell.model_dump()):
        is_pose = isinstance(value, list | tuple) and len(value) == 6
        if is_pose and key.rsplit(".", 1)[-1].startswith("flange_T_"):
            away_mm = float(np.linalg.norm(value[:3]))
            if away_mm > _FARTHEST_MM:
                far.add(key)
                allowed = f"within {_FARTHEST_MM:g} mm of the flange; this is {away_mm:.0f} mm away"
                yield ConfigIssue(key, str(list(value)), allowed)
    for section in ("cameras", "stereo_cameras"):
        for name, camera in cell.section(section).items():
            key = f"{section}.{name}.flange_T_camera"
            written = getattr(camera, "flange_T_camera", None)
            if written is None or key in far:
                continue
            axis = pose_from_xyzabc(written).rotation.as_matrix()[:, 2]
            if axis[2] < _BACK:
                allowed = "a camera that looks away from the arm; its axis points back at it"
                yield ConfigIssue(key, str(list(written)), allowed)
    yield from _sensors(cell, far)


def _sensors(cell: CellConfig, far: set[str]) -> Iterator[ConfigIssue]:
    for name, sensor in cell.force_sensors.items():
        key = f"force_sensors.{name}.flange_T_sensor"
        axis = pose_from_xyzabc(sensor.flange_T_sensor).rotation.as_matrix()[:, 2]
        if key not in far and abs(axis[2]) < _ALONG:
            allowed = (
                "a sensor whose z points along that of the flange, or back: it is bolted between "
                "flange and gripper; B and C near 0 or 180 deg"
            )
            yield ConfigIssue(key, str(list(sensor.flange_T_sensor)), allowed)


def mounted_remarks(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Force sensors that do not lie flat on their flange, or lie on it the other way round."""
    for name, sensor in cell.force_sensors.items():
        axis = pose_from_xyzabc(sensor.flange_T_sensor).rotation.as_matrix()[:, 2]
        tilted_deg = float(np.degrees(np.arccos(min(1.0, abs(float(axis[2]))))))
        if tilted_deg > _FLAT_DEG:
            said = (
                f"tilted by {tilted_deg:.0f} deg against the flange: a disc that is bolted on lies "
                "flat; a weight would be read as a force across"
            )
            written = str(list(sensor.flange_T_sensor))
            yield ConfigIssue(f"force_sensors.{name}.flange_T_sensor", written, said)
        if axis[2] < 0.0:
            said = (
                "its z points back at the arm. If that is wrong, all forces along the tool have "
                "the other sign: a press is felt as a pull, and no touch is. Right if the sensor "
                "is bolted on the other way round; push the tool towards the flange, and "
                "`cellctl check --connect` must show less along z"
            )
            written = str(list(sensor.flange_T_sensor))
            yield ConfigIssue(f"force_sensors.{name}.flange_T_sensor", written, said)


def how_it_lies(sensor: ForceSensorConfig) -> str:
    """What a push by hand must show of a force sensor, by the file.

    Before a first weighing nothing in the file contradicts a wrong turn or a wrong sign, and a cell
    without a load that is weighed never has one.
    """
    axes = pose_from_xyzabc(sensor.flange_T_sensor).rotation.as_matrix()
    turned_deg = round(math.degrees(math.atan2(axes[1, 0], axes[0, 0])))
    along = "along" if axes[2, 2] > 0.0 else "against"
    # By convention a driver that can turn all signs names it so.
    signs = "; inverted = true turns all its signs" if sensor.settings.get("inverted") else ""
    return (
        f"its z points {along} that of the flange, its x is turned by {turned_deg} deg about z "
        f"of the flange{signs}. A push by hand shows whether this is so: while the tool is pushed "
        "towards the flange, `cellctl check --connect` must show less along z (more negative) than "
        "at rest; while it is pushed along x of the flange, more along x"
    )
