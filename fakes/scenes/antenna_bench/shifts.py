"""Devices that no longer stand where they were calibrated: injected, to try a drift check."""

from collections.abc import Mapping

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.faults import FaultBoard
from fakes.world.frames import MM, displacement

SHIFT_FAULTS: Mapping[str, str] = {
    "camera_1_shifted": "camera I has slipped on the flange by `x_mm`, `y_mm` in the flange's axes",
    "camera_2_shifted": "camera II has slipped by `x_mm`, `y_mm` in the axes of the cell",
    "marks_shifted": "the gripper's marks have slipped by `x_mm`, `y_mm` in the flange's axes",
    "plate_shifted": "the reference plate has slipped by `x_mm`, `y_mm` in the axes of the cell",
}
"""Each with `turn_deg` about z of these axes, in place."""


def shifted(faults: FaultBoard, name: str, parent_T_body: RigidTransform) -> RigidTransform:
    """Where a body is while the fault is injected; without a size it has slipped by 20 µm in x."""
    fault = faults.active(name)
    if fault is None:
        return parent_T_body
    turn = displacement(np.zeros(3), [0.0, 0.0, np.deg2rad(fault.number("turn_deg", 0.0))])
    slip_m = np.array([fault.number("x_mm", 0.02), fault.number("y_mm", 0.0), 0.0]) * MM
    return RigidTransform.from_components(
        parent_T_body.translation + slip_m, turn.rotation * parent_T_body.rotation
    )
