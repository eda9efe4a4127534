"""What cameras without errors make of bodies whose poses are known."""

from collections.abc import Mapping

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.antenna_module.connector.connector import Connector
from cellctl.processes.antenna_module.vision.measurement import (
    ConnectorMeasurement,
    ContactState,
    MeasuredContact,
    MeasuredMarks,
)
from cellctl.processes.antenna_module.vision.plane import PlaneCalibration
from tests.rigs.antenna.exact_cell import SEEN


def seen_in(
    plane: PlaneCalibration, base_T_camera: RigidTransform, base_T_body: RigidTransform
) -> MeasuredMarks:
    """A body as it is measured in a plane: where its ray meets that, and how large it looks."""
    true = base_T_camera.inv() * base_T_body
    normal = plane.camera_T_plane.rotation.as_matrix()[:, 2]
    scale = float(normal @ plane.camera_T_plane.translation / (normal @ true.translation))
    pose = RigidTransform.from_components(true.translation * scale, true.rotation)
    return MeasuredMarks(UncertainPose(pose, SEEN), np.zeros((3, 2)), 10.0, scale)


def connector_shown(
    drawing: Connector,
    seen: MeasuredMarks,
    marks: MeasuredMarks | None,
    bad: Mapping[str, ContactState],
) -> ConnectorMeasurement:
    contacts = tuple(
        MeasuredContact(name, bad.get(name, "ok"), np.zeros(2), np.eye(2), np.zeros(2))
        for name in drawing.contacts
    )
    return ConnectorMeasurement(
        "default", drawing.name, "camera", contacts, 8.0, seen.camera_T_marks, seen.scale, 20.0, 27,
        marks,
    )  # fmt: skip
