"""The plane in which pixels become millimetres, and its file.

The plane has its frame: z points towards the camera. A file may state the opposite direction, as
calibration boards do; the frame is then turned by half a turn about its x.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar, Self

import numpy as np
from pydantic import Field, model_validator
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.input_file import InputFile, InputPose, read_input
from cellctl.errors.config import FileInvalid
from cellctl.geometry.pose import MM, Array
from cellctl.processes.antenna_module.faults.connector import ForeignIntrinsics, PlaneFileInvalid
from cellctl.vision.camera.lens import project, undistort
from cellctl.vision.camera.single_camera import SingleCamera
from cellctl.vision.camera.stereo_head import CameraModel

_HALF_TURN = RigidTransform.from_rotation(Rotation.from_euler("x", 180, degrees=True))
_FLATTEST = 0.3
"""Least cosine between the camera's axis and the plane's normal: beyond it rims are too narrow."""


@dataclass(frozen=True, slots=True, eq=False)
class MeasuringPlane:
    """A plane before a camera."""

    camera: CameraModel
    camera_T_plane: RigidTransform
    """z towards the camera."""

    def at_height(self, height_m: float) -> "MeasuringPlane":
        """The parallel plane that is nearer to the camera by this."""
        raised = RigidTransform.from_translation([0.0, 0.0, height_m])
        return MeasuringPlane(self.camera, self.camera_T_plane * raised)

    def from_px(self, pixels: Array) -> Array:
        """Points of the plane, shape (n, 2), m, where the rays of raw pixels (n, 2) meet it."""
        rays = np.column_stack([undistort(self.camera, pixels), np.ones(len(pixels))])
        origin = self.camera_T_plane.translation
        axes = self.camera_T_plane.rotation.as_matrix()
        lengths = (axes[:, 2] @ origin) / (rays @ axes[:, 2])
        return np.asarray((rays * lengths[:, None] - origin) @ axes[:, :2])

    def to_px(self, points_m: Array) -> Array:
        """Raw pixels, shape (n, 2), of points of the plane, shape (n, 2)."""
        flat = np.column_stack([points_m, np.zeros(len(points_m))])
        return project(self.camera, np.asarray(self.camera_T_plane.apply(flat)))

    def px_by_m(self, point_m: Array) -> Array:
        """Derivative of the raw pixel by the place in the plane, shape (2, 2), px/m."""
        # Central differences over less than a pixel, in which every lens is as good as linear.
        step_m = 1e-5
        probe = point_m + step_m * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
        pixels = self.to_px(probe)
        return np.column_stack([pixels[0] - pixels[1], pixels[2] - pixels[3]]) / (2.0 * step_m)

    def m_per_px(self, point_m: Array) -> float:
        """Size of a pixel at a point of the plane, mean of both directions."""
        return float(1.0 / np.sqrt(abs(np.linalg.det(self.px_by_m(point_m)))))


@dataclass(frozen=True, slots=True, eq=False)
class ExpectedPlace:
    """Where the connector was when the station was trained."""

    camera_T_connector: RigidTransform
    within_m: float
    within_rad: float


@dataclass(frozen=True, slots=True, eq=False)
class PlaneCalibration:
    """What a plane file says."""

    camera_id: str
    camera_T_plane: RigidTransform
    sigma_height_m: float
    sigma_tilt_rad: float
    expected: ExpectedPlace | None

    def before(self, camera: SingleCamera) -> MeasuringPlane:
        """The plane with the camera that it belongs to; raises ``ForeignIntrinsics``."""
        if camera.id != self.camera_id:
            raise ForeignIntrinsics(
                f"plane made with {self.camera_id[:12]}, camera is {camera.id[:12]}"
            )
        return MeasuringPlane(camera.model, self.camera_T_plane)


class _ExpectedTable(InputFile):
    camera_T_connector: InputPose
    within_mm: Annotated[float, Field(gt=0, le=100)] = 2.0
    within_deg: Annotated[float, Field(gt=0, le=45)] = 2.0


class PlaneFile(InputFile):
    """The file, in mm and degrees."""

    seen_from_afar: ClassVar[bool] = True

    camera_id: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    camera_T_plane: InputPose
    sigma_height_mm: Annotated[float, Field(ge=0, le=10)] = 0.2
    sigma_tilt_deg: Annotated[float, Field(ge=0, le=10)] = 0.1
    expected: _ExpectedTable | None = None

    @model_validator(mode="after")
    def _is_before_the_camera(self) -> Self:
        if self.camera_T_plane.translation[2] <= 0:
            raise ValueError("camera_T_plane lies behind the camera")
        if abs(self.camera_T_plane.rotation.as_matrix()[2, 2]) < _FLATTEST:
            raise ValueError("camera_T_plane is seen almost edge-on")
        return self


def read_plane(path: Path) -> PlaneCalibration:
    """Read a plane file; raises ``PlaneFileInvalid`` with everything that is wrong."""
    try:
        file = read_input(path, PlaneFile)
    except FileInvalid as error:
        raise PlaneFileInvalid(error.detail) from error
    place = file.expected
    return PlaneCalibration(
        camera_id=file.camera_id,
        camera_T_plane=facing_camera(file.camera_T_plane),
        sigma_height_m=file.sigma_height_mm * MM,
        sigma_tilt_rad=float(np.radians(file.sigma_tilt_deg)),
        expected=None
        if place is None
        else ExpectedPlace(
            place.camera_T_connector, place.within_mm * MM, float(np.radians(place.within_deg))
        ),
    )


def facing_camera(camera_T_plane: RigidTransform) -> RigidTransform:
    """The same plane with z towards the camera."""
    away = camera_T_plane.rotation.as_matrix()[2, 2] > 0
    return camera_T_plane * _HALF_TURN if away else camera_T_plane
