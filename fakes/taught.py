"""Taught poses of the nominal cell, as an integrator would write them into the cell file."""

from typing import Any

import numpy as np

from fakes.scenario_file.scenario import Scenario
from fakes.world.arm import forward, inverse, nominal_links
from fakes.world.frames import from_written, to_written


def taught(scenario: Scenario) -> dict[str, Any]:
    """Joint angles in degrees of every taught pose, flange poses in the robot's base, mountings."""
    return {
        "robots": {name: _robot(scenario, name) for name in scenario.robots},
        "cameras": {
            name: {
                "carried_by": camera.carried_by,
                "flange_T_camera_mm_deg": camera.flange_T_camera_mm_deg,
                "cell_T_camera_mm_deg": camera.cell_T_camera_mm_deg,
            }
            for name, camera in scenario.all_cameras().items()
        },
        "force_sensors": {
            name: {
                "mounted_on": sensor.mounted_on,
                "flange_T_sensor_mm_deg": sensor.flange_T_sensor_mm_deg,
            }
            for name, sensor in scenario.force_sensors.items()
        },
        "trackers": {
            name: {"cell_T_tracker_mm_deg": tracker.cell_T_tracker_mm_deg}
            for name, tracker in scenario.trackers.items()
        },
        **scenario.nominal_poses(),
    }


def _robot(scenario: Scenario, name: str) -> dict[str, Any]:
    robot = scenario.robots[name]
    cell_T_base = from_written(robot.base_mm_deg)
    joints = np.deg2rad(robot.home_deg)
    home = forward(nominal_links(robot.chain_mm), joints)
    poses = {"home": _entry(joints, to_written(home))}
    for pose, written in scenario.taught.get(name, {}).items():
        base_T_flange = cell_T_base.inv() * from_written(written)
        joints = inverse(robot.chain_mm, base_T_flange, joints)
        poses[pose] = _entry(joints, to_written(base_T_flange))
    return {
        "name": robot.name,
        "chain_mm": robot.chain_mm.model_dump(),
        "limits_deg": [list(pair) for pair in robot.limits_deg],
        "base_mm_deg": list(robot.base_mm_deg),
        "poses": poses,
    }


def _entry(joints_rad: Any, written: list[float]) -> dict[str, list[float]]:
    return {
        "joints_deg": [round(float(angle), 5) + 0.0 for angle in np.rad2deg(joints_rad)],
        "base_T_flange_mm_deg": [round(value, 4) + 0.0 for value in written],
    }
