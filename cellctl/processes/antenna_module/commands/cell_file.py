"""The part of a trial's or a teaching's file that describes the cell."""

from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, PlainValidator, model_validator
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.input_file import InputFile, InputPose, numbers, read_input
from cellctl.calibration.pose_record import covariance_from_written
from cellctl.geometry.pose import MM, Array
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.antenna_module.chain.cell_figures import (
    RP_OVER_SIGMA,
    ArmFigures,
    CameraFigures,
    MountedCamera,
    PlugCell,
)
from cellctl.processes.antenna_module.commands.measurement_file import Identity
from cellctl.processes.antenna_module.faults.plugging import CalibrationsDoNotBelongTogether
from cellctl.sealed_json import content_id


def _joints_rad(values: Any) -> Array:
    return np.asarray(np.radians(numbers(values, (6,), "joints_deg must be six numbers")))


Joints = Annotated[Array, PlainValidator(_joints_rad)]
"""Written in degrees; shape (6,), rad."""
_Small = Annotated[float, Field(ge=0, le=10)]


class CameraPoseRecord(InputFile):
    """A pose as the calibrations write it."""

    matrix_mm: InputPose
    covariance_mm_deg: Annotated[
        Array,
        PlainValidator(
            lambda values: covariance_from_written(
                numbers(values, (6, 6), "covariance_mm_deg must be 6 x 6")
            )
        ),
    ]


class HandEyeRecord(InputFile):
    """What ``cellctl calibrate hand-eye`` has written, of either setup."""

    camera_id: Identity
    flange_T_camera: CameraPoseRecord | None = None
    base_T_camera: CameraPoseRecord | None = None

    def mounted(self, identity: str, *, in_hand: bool) -> MountedCamera:
        """The camera; raises ``ValueError`` for a record of the other setup."""
        record = self.flange_T_camera if in_hand else self.base_T_camera
        if record is None:
            wanted = "flange_T_camera" if in_hand else "base_T_camera"
            raise ValueError(f"the hand-eye calibration has no {wanted}: it is of the other setup")
        pose = UncertainPose(record.matrix_mm, record.covariance_mm_deg)
        return MountedCamera(identity, self.camera_id, pose)


class ArmEntry(InputFile):
    """The robot's figures."""

    rp_mm: _Small
    """RP of ISO 9283."""
    rp_deg: _Small
    """Standard deviation of the flange's angles from approach to approach."""
    absolute_error_mm: _Small
    drift_mm: _Small = 0.0

    def figures(self) -> ArmFigures:
        """In SI."""
        return ArmFigures(
            repeatability_m=self.rp_mm / RP_OVER_SIGMA * MM,
            repeatability_rad=float(np.radians(self.rp_deg)),
            absolute_error_m=self.absolute_error_mm * MM,
            drift_m=self.drift_mm * MM,
        )


class CamerasEntry(InputFile):
    """What stays wrong in both cameras, and the intrinsics in use."""

    cam1: Identity
    cam2: Identity
    feature_bias_mm: _Small = 0.005
    drift_mm: _Small = 0.004
    drift_deg: _Small = 0.001

    def figures(self) -> CameraFigures:
        """In SI."""
        return CameraFigures(
            self.feature_bias_mm * MM, self.drift_mm * MM, float(np.radians(self.drift_deg))
        )


class CellEntries(InputFile):
    """Keys that a trial and a teaching share."""

    scheme: str = "difference"
    cameras: CamerasEntry
    flange_T_cam1: HandEyeRecord
    base_T_cam2: HandEyeRecord
    arm: ArmEntry
    gripper: Identity
    """Name in the drawing of the gripper's marks."""
    flange_T_marks: InputPose = Field(default_factory=RigidTransform.identity)

    @model_validator(mode="after")
    def _is_of_both_setups(self) -> "CellEntries":
        self.flange_T_cam1.mounted("", in_hand=True)
        self.base_T_cam2.mounted("", in_hand=False)
        return self

    def cell(self) -> PlugCell:
        """The cell of these entries.

        Raises ``CalibrationsDoNotBelongTogether`` when a hand-eye calibration was made with other
        intrinsics than those in use.
        """
        for used, mounted in (
            (self.cameras.cam1, self.flange_T_cam1),
            (self.cameras.cam2, self.base_T_cam2),
        ):
            if used != mounted.camera_id:
                raise CalibrationsDoNotBelongTogether(
                    f"intrinsics {used}, hand-eye made with {mounted.camera_id}"
                )
        return PlugCell(
            cam1=self.flange_T_cam1.mounted(_identity(self.flange_T_cam1), in_hand=True),
            cam2=self.base_T_cam2.mounted(_identity(self.base_T_cam2), in_hand=False),
            arm=self.arm.figures(),
            cameras=self.cameras.figures(),
            gripper=self.gripper,
            flange_T_marks=self.flange_T_marks,
        )


def _identity(record: HandEyeRecord) -> str:
    """SHA-256 of what counts in it, so that a new calibration has another one."""
    poses = [
        [pose.matrix_mm.as_matrix().tolist(), pose.covariance_mm_deg.tolist()]
        for pose in (record.flange_T_camera, record.base_T_camera)
        if pose is not None
    ]
    return content_id({"camera_id": record.camera_id, "poses": poses})


def read_relative(path: Path, value: Any) -> Any:
    """A value, or what stands in the JSON file that it names beside ``path``."""
    if not isinstance(value, str):
        return value
    return read_input(path.parent / value, AnyObject).root()


class AnyObject(InputFile):
    """A JSON object of any keys."""

    model_config = InputFile.model_config | {"extra": "allow"}

    def root(self) -> dict[str, Any]:
        """Its content."""
        return dict(self.model_extra or {})
