"""What the commands on plugs read from files, made from an exact cell."""

from typing import Any

import numpy as np

from cellctl.calibration.pose_record import pose_to_record
from cellctl.geometry.pose import pose_to_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.antenna_module.chain.looks import Look, Looks
from cellctl.processes.antenna_module.vision.result_file import COVARIANCE_UNITS
from tests.rigs.antenna import exact_cell as exact

Json = dict[str, Any]


def mm(pose: Any) -> list[float]:
    return [float(value) for value in pose_to_xyzabc(pose)]


def measurement(seen: UncertainPose, camera: str, connector: str) -> Json:
    return {
        "camera_id": camera,
        "connector": connector,
        "camera_T_connector": mm(seen.pose),
        "covariance": (seen.covariance / np.outer(COVARIANCE_UNITS, COVARIANCE_UNITS)).tolist(),
    }


def look_entry(station: str, look: Look, found: Json) -> Json:
    return {
        "station": station,
        "base_T_flange": mm(look.base_T_flange),
        "joints_deg": np.degrees(look.joints_rad).tolist(),
        "measurement": found,
        "time_s": look.time_s,
    }


def look_entries(looks: Looks) -> list[Json]:
    plug = looks.plug
    found = measurement(plug.camera_T_plug, plug.camera_id, plug.connector)
    assert plug.camera_T_marks is not None
    found["marks_T_connector"] = mm(plug.camera_T_marks.pose.inv() * plug.camera_T_plug.pose)
    sockets = [
        look_entry("socket", one, measurement(one.camera_T_socket, one.camera_id, one.connector))
        for one in looks.sockets
    ]
    return [look_entry("plug", plug, found), *sockets]


def cell_entries() -> Json:
    cell = exact.cell()
    cam1, cam2 = pose_to_record(cell.cam1.pose), pose_to_record(cell.cam2.pose)
    return {
        "scheme": "difference",
        "cameras": {"cam1": "camera 1", "cam2": "camera 2"},
        "flange_T_cam1": {"camera_id": "camera 1", "flange_T_camera": cam1},
        "base_T_cam2": {"camera_id": "camera 2", "base_T_camera": cam2},
        "arm": {"rp_mm": 0.02, "rp_deg": 0.001, "absolute_error_mm": 0.26, "drift_mm": 0.024},
        "gripper": "gripper 3",
        "flange_T_marks": mm(exact.FLANGE_T_MARKS),
    }


def teach_content() -> Json:
    plugs = [
        {
            "name": plug.name,
            "looks": look_entries(plug.looks),
            "plugged_base_T_flange": mm(plug.base_T_flange),
        }
        for plug in exact.taught_plugs()
    ]
    return {**cell_entries(), "plugs": plugs}
