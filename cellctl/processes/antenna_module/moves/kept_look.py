"""One look at marks as the record of a procedure keeps it, and the marks measured anew from it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.antenna_module.connector.marks import Marks
from cellctl.processes.antenna_module.looking import marks_by
from cellctl.processes.antenna_module.recipe import Place
from cellctl.vision.camera.single_camera import (
    SingleCamera,
    single_camera_from_json,
    single_camera_to_json,
)


@dataclass(frozen=True, slots=True, eq=False)
class KeptLook:
    """Everything that one measurement of marks was made from."""

    image: str
    """Name of the file."""
    camera: SingleCamera
    marks: Marks
    camera_T_marks: RigidTransform
    """Where they were expected."""
    place: Place
    """How certain that is."""
    base_T_flange: RigidTransform
    """Pose of the flange that the arm reported meanwhile."""
    angle_rad: float = 0.0
    """Angle of the last joint, where the gripper was turned for the look."""

    def again(self, image: Callable[[str], Image]) -> RigidTransform:
        """``camera_T_marks`` as it is measured today; ``image`` reads one by its file.

        Raises what ``measure_marks`` raises.
        """
        measure = marks_by(self.camera, self.marks, self.camera_T_marks, self.place)
        return measure(image(self.image)).camera_T_marks.pose

    def to_input(self) -> dict[str, Any]:
        """Plain data with all digits."""
        return {
            "image": self.image,
            "camera": single_camera_to_json(self.camera),
            "marks": _marks_to_input(self.marks),
            "camera_T_marks_expected": self.camera_T_marks.as_matrix().tolist(),
            "place": self.place.model_dump(mode="json"),
            "base_T_flange": self.base_T_flange.as_matrix().tolist(),
            "angle_rad": self.angle_rad,
        }

    @classmethod
    def from_input(cls, written: Mapping[str, Any]) -> "KeptLook":
        """The inverse of ``to_input``."""
        return cls(
            written["image"],
            single_camera_from_json(written["camera"]),
            _marks_from_input(written["marks"]),
            matrix_pose(written["camera_T_marks_expected"]),
            Place.model_validate(written["place"]),
            matrix_pose(written["base_T_flange"]),
            written["angle_rad"],
        )


def matrix_pose(matrix: Any) -> RigidTransform:
    """A pose from its matrix in m."""
    return RigidTransform.from_matrix(np.array(matrix, float))


def _marks_to_input(marks: Marks) -> dict[str, Any]:
    return {
        "name": marks.name,
        "bright": marks.bright,
        "names": list(marks.names),
        "positions_m": marks.positions_m.tolist(),
        "diameter_m": marks.diameter_m,
        "height_m": marks.height_m,
        "marks_T_connector": marks.marks_T_connector.as_matrix().tolist(),
        "within_m": marks.within_m,
        "within_rad": marks.within_rad,
        "places_id": marks.places_id,
    }


def _marks_from_input(written: Mapping[str, Any]) -> Marks:
    return Marks(
        **{
            **written,
            "names": tuple(written["names"]),
            "positions_m": np.array(written["positions_m"], float),
            "marks_T_connector": matrix_pose(written["marks_T_connector"]),
        }
    )
