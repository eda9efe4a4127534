"""A small rendered plug with its files; each picture is made once in a run of the tests."""

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.vision.plane import PlaneCalibration, facing_camera
from cellctl.vision.camera.single_camera import SingleCamera, single_camera_to_json
from fakes.render.connectors import api
from tests.rigs.antenna.pictures import exact_model

CONNECTOR = Path("config/connectors/micro-d-15-pins.toml")
SIZE_PX = (460, 230)
UM_PER_PX = 35.0


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """An image, blue green red, and the true pose of the drawing."""

    image: NDArray[np.uint8]
    camera: SingleCamera
    camera_T_connector: RigidTransform

    def plane(self) -> PlaneCalibration:
        """The plane of the tips."""
        pose = RigidTransform.from_translation([0.0, 0.0, api.WORKING_DISTANCE_M])
        return PlaneCalibration(self.camera.id, facing_camera(pose), 2e-4, 0.0017, None)

    def write(self, folder: Path) -> None:
        """The files of the command: camera, plane with the trained place, image."""
        camera = single_camera_to_json(self.camera)
        (folder / "cam.json").write_text(json.dumps(camera))
        trained = np.array(api.facing().as_matrix())
        trained[:3, 3] /= MM
        plane = {
            "camera_id": self.camera.id,
            "camera_T_plane": [0.0, 0.0, api.WORKING_DISTANCE_M / MM, 0.0, 0.0, 0.0],
            "expected": {"camera_T_connector": trained.tolist(), "within_deg": 5.0},
        }
        (folder / "plane.json").write_text(json.dumps(plane))
        cv2.imwrite(str(folder / "a.png"), self.image)


@cache
def picture(
    missing: tuple[str, ...] = (), bent: str = "", turn_deg: float = 0.0, noise: int = 5
) -> Picture:
    """A micro-D plug 0.3 mm off the axis, without true position errors."""
    camera = api.nominal_camera(um_per_px=UM_PER_PX, size_px=SIZE_PX)
    pose = api.facing(shift_m=(3e-4, -2e-4, 0.0), yaw_deg=3.0 + turn_deg)
    body = api.connector_as_made(
        "micro-d-15",
        "pins",
        seed=3,
        camera_T_connector=pose,
        true_position_m=0.0,
        missing=missing,
        bent_m={bent: (1.2e-4, 0.0)} if bent else {},
    )
    shown = api.render(camera, (body,), pixels="rgb", seed=noise)
    return Picture(
        np.ascontiguousarray(shown.image[:, :, ::-1]),
        exact_model(camera),
        pose,
    )
