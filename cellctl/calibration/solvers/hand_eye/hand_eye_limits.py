"""What a hand-eye calibration must reach, from what robot, camera and distance allow.

The stated noise of the robot, carried to the board over the working distance, and that of the
camera's poses, which focal length and board determine, say how far the board may seem to be off
its place. A limit in millimetres would fit one size of cell only.
"""

from dataclasses import dataclass

import numpy as np

from cellctl.calibration.checks import Checks, LimitCheck
from cellctl.calibration.solvers.hand_eye.hand_eye_result import Setup
from cellctl.geometry.pose import MM, Array
from cellctl.geometry.uncertain import UncertainPose

_RESIDUAL_RATIO = 3.0
"""Largest residual over the expected one: stated noise is seldom right to better than a factor of
two."""
_SIGMA_RATIO = 1.0
"""Largest standard deviation of the result over the expected residual of one pose: many poses must
tell more than one does."""
_SCALE, _SCALE_SIGMAS = 0.01, 4.0
"""Largest difference of the board's lengths from the robot's, where the poses tell it so well."""


@dataclass(frozen=True, slots=True)
class HandEyeLimits:
    """Limits of the result; None for what the stated noise allows at this distance."""

    poses: int = 8
    rms_m: float | None = None
    rms_rad: float | None = None
    position_sigma_m: float | None = None
    rotation_sigma_rad: float | None = None

    def checks(
        self,
        camera: UncertainPose,
        residuals: Array,
        expected: tuple[float, float],
        scale: tuple[float, float],
    ) -> Checks:
        """The figures of a result.

        ``residuals`` (n, 2) are distances (m) and angles (rad) of the board in the poses that
        count, ``expected`` their rms by the stated noise, ``scale`` the robot's lengths over the
        board's and its standard deviation.
        """
        expected_m, expected_rad = expected
        rms_m, rms_rad = np.sqrt((residuals**2).mean(axis=0))
        most_m = self.rms_m or _RESIDUAL_RATIO * expected_m
        most_rad = self.rms_rad or _RESIDUAL_RATIO * expected_rad
        sigma_m = self.position_sigma_m or _SIGMA_RATIO * expected_m
        sigma_rad = self.rotation_sigma_rad or _SIGMA_RATIO * expected_rad
        sigma, degrees = camera.sigma, np.degrees
        return (
            LimitCheck("poses", len(residuals), self.poses, "", "min"),
            LimitCheck("residual rms", rms_m / MM, most_m / MM, "mm"),
            LimitCheck("residual rms", degrees(rms_rad), float(degrees(most_rad)), "°"),
            LimitCheck("position sigma", sigma[:3].max() / MM, sigma_m / MM, "mm"),
            LimitCheck("rotation sigma", degrees(sigma[3:].max()), float(degrees(sigma_rad)), "°"),
            LimitCheck(
                "board's lengths against the robot's",
                abs(scale[0] - 1.0),
                max(_SCALE, _SCALE_SIGMAS * scale[1]),
                "",
            ),
        )


def mounting_check(setup: Setup, camera: UncertainPose, board: UncertainPose) -> LimitCheck:
    """What the flange carries is nearer to it than what stands is to the base.

    Poses that are all inverted fit as well as the right ones, with camera and board in each other's
    place: only their distances tell which is which.
    """
    camera_mm, board_mm = (
        float(np.linalg.norm(one.pose.translation)) / MM for one in (camera, board)
    )
    if setup is Setup.EYE_IN_HAND:
        name = "camera from the flange, less than the board from the base"
        return LimitCheck(name, camera_mm, board_mm, "mm")
    name = "board from the flange, less than the camera from the base"
    return LimitCheck(name, board_mm, camera_mm, "mm")
