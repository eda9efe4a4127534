"""The input file of a hand-eye calibration."""

from collections import Counter
from collections.abc import Iterator
from typing import Annotated, Any

import numpy as np
from pydantic import Field, PlainValidator, model_validator

from cellctl.calibration.boards.board_in_camera import board_in_camera
from cellctl.calibration.input_file import (
    InputFile,
    InputPoints,
    InputPose,
    InputPoseCovariance,
    numbers,
)
from cellctl.calibration.solvers.hand_eye.hand_eye_result import HandEyePose, RobotNoise, Setup
from cellctl.calibration.solvers.hand_eye.one_wrist import require_one_wrist
from cellctl.geometry.pose import MM, Array
from cellctl.geometry.uncertain import UncertainPose
from cellctl.vision.camera.stereo_head import DISTORTION_TERMS, CameraModel


def _camera_matrix(values: Any) -> Array:
    return numbers(values, (3, 3), "camera_matrix must be 3 x 3")


def _distortion(values: Any) -> Array:
    given = numbers(values, (None,), "distortion must be a list of numbers")
    # OpenCV also writes four numbers, without k3.
    if len(given) == 4:
        given = np.append(given, 0.0)
    if len(given) not in DISTORTION_TERMS:
        raise ValueError(f"distortion must have 4, 5, 8, 12 or 14 numbers, has {len(given)}")
    return given


def _pixels(values: Any) -> Array:
    return numbers(values, (None, 2), "corners_px must be a list of [u, v]")


def _joints(values: Any) -> Array:
    return numbers(values, (6,), "joints_deg must be six numbers")


Sigma = Annotated[float, Field(ge=1e-6, le=100.0)]
"""A standard deviation. Everything is weighed by its inverse: with none at all the one pose that is
said to be exact would decide alone, and no division holds."""


class HandEyeCamera(InputFile):
    """The camera that saw the corners."""

    camera_matrix: Annotated[Array, PlainValidator(_camera_matrix)]
    distortion: Annotated[Array, PlainValidator(_distortion)] = Field(
        default_factory=lambda: np.zeros(5)
    )


class HandEyeEntry(InputFile):
    """One stop: the robot, and the board as a pose or by its corners."""

    name: str | None = None
    joints_deg: Annotated[Array, PlainValidator(_joints)] | None = None
    base_T_flange: InputPose
    camera_T_board: InputPose | None = None
    covariance_mm_deg: InputPoseCovariance | None = None
    corners_px: Annotated[Array, PlainValidator(_pixels)] | None = None
    board_points_mm: InputPoints | None = None

    @model_validator(mode="after")
    def _has_the_board(self) -> "HandEyeEntry":
        if self.camera_T_board is None and self.corners_px is None:
            raise ValueError("missing 'camera_T_board'")
        return self


class HandEyeFile(InputFile):
    """The whole file."""

    # With the lengths of robot and camera both in metres the poses fit, and nothing else tells it.
    seen_from_afar = True

    setup: Setup | None = None
    camera_id: str | None = None
    """Identity of the intrinsics in use; it stands in the result, too."""
    poses: tuple[HandEyeEntry, ...]
    robot_sigma_mm: Sigma = 0.05
    robot_sigma_deg: Sigma = 0.005
    camera_sigma_mm: Sigma = 0.02
    """Standard deviation of poses of the board that have no covariance."""
    camera_sigma_deg: Sigma = 0.005
    camera_sigma_px: Sigma | None = None
    """Noise of corners; without it the noise that their residuals show."""
    camera: HandEyeCamera | None = None
    board_points_mm: InputPoints | None = None
    """Points of the board for entries that have none of their own."""

    @model_validator(mode="after")
    def _corners_have_camera_and_board(self) -> "HandEyeFile":
        for number, entry in enumerate(self.poses, start=1):
            if entry.corners_px is None:
                continue
            if self.camera is None:
                raise ValueError(f"poses, entry {number}: corners_px, but missing 'camera'")
            if entry.board_points_mm is None and self.board_points_mm is None:
                raise ValueError(f"poses, entry {number}: missing 'board_points_mm'")
        return self

    @model_validator(mode="after")
    def _names_tell_poses_apart(self) -> "HandEyeFile":
        # Residuals, rejected poses and joints are kept by name: of two poses with one name, one
        # would be judged by the other's figures.
        counted = Counter(name for name, _ in self._named())
        twice = [name for name, count in counted.items() if count > 1]
        if twice:
            raise ValueError(
                f"poses: the name {twice[0]!r} is given to {counted[twice[0]]} of them"
            )
        return self

    def robot_noise(self) -> RobotNoise:
        """Noise of the reported flange poses."""
        return RobotNoise(self.robot_sigma_mm * MM, float(np.radians(self.robot_sigma_deg)))

    def stops(self) -> tuple[HandEyePose, ...]:
        """Input of the solver.

        Raises ``BoardPoseInvalid`` when corners give no pose, ``WristConfigurationsDiffer`` when
        the joints that the file gives mix two ways in which the arm is folded.
        """
        require_one_wrist(
            {
                name: np.radians(entry.joints_deg)
                for name, entry in self._named()
                if entry.joints_deg is not None
            }
        )
        return tuple(
            HandEyePose(name, entry.base_T_flange, self._board(entry))
            for name, entry in self._named()
        )

    def _named(self) -> Iterator[tuple[str, HandEyeEntry]]:
        """Each entry with its name; one without is called by its number."""
        for number, entry in enumerate(self.poses, start=1):
            yield entry.name or f"pose {number}", entry

    def _board(self, entry: HandEyeEntry) -> UncertainPose:
        """camera_T_board as given, or from corners."""
        points_m = self.board_points_mm if entry.board_points_mm is None else entry.board_points_mm
        if entry.corners_px is not None and self.camera is not None and points_m is not None:
            camera = CameraModel(self.camera.camera_matrix, self.camera.distortion)
            return board_in_camera(camera, points_m, entry.corners_px, self.camera_sigma_px)[0]
        if entry.camera_T_board is None:
            raise ValueError("an entry without pose and corners is no valid file")
        covariance = entry.covariance_mm_deg
        if covariance is None:
            sigma_m, sigma_rad = self.camera_sigma_mm * MM, np.radians(self.camera_sigma_deg)
            # A file without covariances is common; one figure for all poses still gives each pose
            # its weight against the robot's noise.
            covariance = np.diag([sigma_m**2] * 3 + [sigma_rad**2] * 3)
        return UncertainPose(entry.camera_T_board, covariance)
