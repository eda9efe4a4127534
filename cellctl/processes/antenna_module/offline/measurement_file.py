"""What ``cellctl measure-connector`` has written of one picture, as far as a plan needs it."""

from typing import Annotated

from pydantic import Field
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.input_file import InputFile, InputPose, InputPoseCovariance
from cellctl.geometry.uncertain import UncertainPose

Identity = Annotated[str, Field(min_length=1, max_length=128)]


class Measurement(InputFile):
    """One picture of one connector."""

    camera_id: Identity
    """Of the intrinsics that it was measured with."""
    connector: Identity
    """Name in the connector's drawing."""
    camera_T_connector: InputPose
    covariance: InputPoseCovariance
    """In mm and degrees, with priors for what the picture does not measure."""
    camera_T_marks: InputPose | None = None
    marks_covariance: InputPoseCovariance | None = None
    marks_T_connector: InputPose | None = None

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
