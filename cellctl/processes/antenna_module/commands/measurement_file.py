"""What ``cellctl measure-connector`` has written of one picture, as far as a plan needs it."""

from typing import Annotated, Any

import numpy as np
from pydantic import Field, PlainValidator, model_validator
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.input_file import InputFile, InputPose, numbers
from cellctl.calibration.pose_record import require_covariance
from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.antenna_module.vision.result_file import COVARIANCE_ORDER, COVARIANCE_UNITS


def _covariance(values: Any) -> Array:
    written = numbers(values, (6, 6), "a covariance must be 6 x 6")
    return require_covariance(written * np.outer(COVARIANCE_UNITS, COVARIANCE_UNITS))


Covariance = Annotated[Array, PlainValidator(_covariance)]
"""Written in mm and rad; shape (6, 6), m and rad."""
Identity = Annotated[str, Field(min_length=1, max_length=128)]


class Measurement(InputFile):
    """One picture of one connector."""

    camera_id: Identity
    """Of the intrinsics that it was measured with."""
    connector: Identity
    """Name in the connector's drawing."""
    camera_T_connector: InputPose
    covariance: Covariance
    """With priors for what the picture does not measure."""
    covariance_order: tuple[str, ...] = COVARIANCE_ORDER
    camera_T_marks: InputPose | None = None
    marks_covariance: Covariance | None = None
    marks_T_connector: InputPose | None = None

    @model_validator(mode="after")
    def _is_of_this_order(self) -> "Measurement":
        if self.covariance_order != COVARIANCE_ORDER:
            raise ValueError(f"covariance_order must be {', '.join(COVARIANCE_ORDER)}")
        return self

    def connector_pose(self) -> UncertainPose:
        """camera_T_connector."""
        return UncertainPose(self.camera_T_connector, self.covariance)

    def marks_pose(self) -> UncertainPose | None:
        """camera_T_marks; without a covariance of its own, with that of the connector.

        The marks are larger and farther apart than contacts, so that is on the safe side.
        """
        pose: RigidTransform | None = self.camera_T_marks
        if pose is None and self.marks_T_connector is not None:
            pose = self.camera_T_connector * self.marks_T_connector.inv()
        if pose is None:
            return None
        covariance = self.marks_covariance
        return UncertainPose(pose, self.covariance if covariance is None else covariance)
