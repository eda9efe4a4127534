"""A whole cell that was drawn at random, calibrated by the package's own hand-eye solver."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from benchmarks.antenna.chain.arms import DrawnArm, Grade, Repeatability
from benchmarks.antenna.chain.optics import PLANE_SIGMA_M, WORKING_DISTANCE_M, DrawnOptics, Optics
from cellctl.calibration.boards.board_in_camera import board_in_camera
from cellctl.calibration.solvers.hand_eye.hand_eye import calibrate_hand_eye
from cellctl.calibration.solvers.hand_eye.hand_eye_result import HandEyePose, RobotNoise, Setup
from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import UncertainPose
from cellctl.vision.camera.stereo_head import CameraModel

LEVER_M = 0.2
"""Distance from the flange to the connector."""
BIAS_M = 5e-6
CORNERS_PX = 0.1
CONTACT_PX = 0.03
HAND_EYE_POSES = 20
MARKS_M = np.array([[25.0, 18.0, 0], [-25.0, 18.0, 0], [25.0, -18.0, 0], [-25.0, -18.0, 0]]) * 1e-3
PLATE_M = MARKS_M.copy()
"""Dots of the plate, seen from either side."""
_BOARD_M = np.array([[x, y, 0.0] for y in range(8) for x in range(11)]) * 5e-3 - [25e-3, 17.5e-3, 0]

DOWN = Rotation.from_euler("y", 180, degrees=True)
"""Orientation of the flange over both stations: its z axis points down."""


def _pose(x: float, y: float, z: float, rotation: Rotation | None = None) -> RigidTransform:
    return RigidTransform.from_components([x, y, z], rotation or Rotation.identity())


PLUG_STATION = _pose(0.48, -0.275, 0.32)
"""base_T_plug when camera II looks at it."""
SOCKET = _pose(0.48, 0.275, 0.22)
"""base_T_socket by the drawing of the panel."""
FLANGE_T_PLUG = _pose(0.0, 0.0, LEVER_M, DOWN)
"""Pose in the drawing: the plug's z axis points up, as the socket's does."""
FLANGE_T_CAM1 = _pose(0.08, 0.0, LEVER_M - WORKING_DISTANCE_M)
"""Looks along the flange axis; at working distance when the flange is at plugging height."""
BASE_T_CAM2 = PLUG_STATION * _pose(0.0, 0.0, -WORKING_DISTANCE_M)
"""Looks up."""
FLANGE_T_MARKS = FLANGE_T_PLUG
PLATE = PLUG_STATION
"""Camera II sees the plate where it sees plugs, while no module is there."""


def small(rng: np.random.Generator, position_m: float, rotation_deg: float) -> RigidTransform:
    """A random small displacement: standard deviations per axis."""
    turn = Rotation.from_rotvec(rng.normal(0, np.radians(rotation_deg), 3))
    return RigidTransform.from_components(rng.normal(0, position_m, 3), turn)


@dataclass(frozen=True, slots=True, eq=False)
class Mounting:
    """Where cameras and marks really are."""

    flange_T_cam1: RigidTransform
    base_T_cam2: RigidTransform
    flange_T_marks: RigidTransform
    base_T_plate: RigidTransform


@dataclass(frozen=True, slots=True, eq=False)
class DrawnCell:
    """The truth of one cell, and what its calibrations found."""

    arm: DrawnArm
    optics1: Optics
    optics2: Optics
    mounting: Mounting
    flange_T_cam1: UncertainPose
    base_T_cam2: UncertainPose
    plane_errors_m: Array
    """How wrong the believed heights are: plug, socket, marks; shape (3,)."""

    @property
    def cam1_T_plane(self) -> RigidTransform:
        """Where sockets are believed to lie before camera I, when it looks at one."""
        look = base_T_flange_over_socket() * self.flange_T_cam1.pose
        return look.inv() * SOCKET * _pose(0, 0, self.plane_errors_m[1])

    def cam2_T_plane(self, error: int = 0) -> RigidTransform:
        """Where plugs (0) or marks (2) are believed to lie before camera II."""
        lift = _pose(0, 0, self.plane_errors_m[error])
        return self.base_T_cam2.pose.inv() * PLUG_STATION * lift

    def warmed(self, rng: np.random.Generator, kelvin: float) -> "DrawnCell":
        """The cell some hours after calibration and teaching."""
        if kelvin == 0:
            return self
        mounting = self.mounting
        moved = replace(
            mounting,
            flange_T_cam1=mounting.flange_T_cam1 * small(rng, 4e-6, 0.001),
            base_T_cam2=mounting.base_T_cam2 * small(rng, 4e-6, 0.001),
        )
        return replace(self, arm=self.arm.warmed(rng, kelvin), mounting=moved)

    def misaligned(
        self, rng: np.random.Generator, position_m: float, rotation_deg: float
    ) -> "DrawnCell":
        """The cell with hand-eye calibrations that are wrong by as much, length and angle."""
        return replace(
            self,
            flange_T_cam1=_moved(self.flange_T_cam1, rng, position_m, rotation_deg),
            base_T_cam2=_moved(self.base_T_cam2, rng, position_m, rotation_deg),
        )


def base_T_flange_over_socket() -> RigidTransform:
    """Camera I over the socket, in the height and the orientation of plugging."""
    return SOCKET * FLANGE_T_PLUG.inv() * _pose(-FLANGE_T_CAM1.translation[0], 0, 0)


def draw_cell(rng: np.random.Generator, grade: Grade, repeatability: Repeatability) -> DrawnCell:
    """A cell with a calibrated pair of cameras."""
    arm = DrawnArm.draw(rng, grade, repeatability)
    optics = DrawnOptics.draw(rng, BIAS_M), DrawnOptics.draw(rng, BIAS_M)
    mounting = Mounting(
        flange_T_cam1=FLANGE_T_CAM1 * small(rng, 5e-4, 0.3),
        base_T_cam2=BASE_T_CAM2 * small(rng, 5e-4, 0.3),
        flange_T_marks=FLANGE_T_MARKS * small(rng, 1.5e-4, 0.1),
        base_T_plate=PLATE * small(rng, 1e-4, 0.1),
    )
    in_hand = _hand_eye((arm, optics[0], mounting), Setup.EYE_IN_HAND, grade, rng)
    to_hand = _hand_eye((arm, optics[1], mounting), Setup.EYE_TO_HAND, grade, rng)
    return DrawnCell(arm, *optics, mounting, in_hand, to_hand, rng.normal(0, PLANE_SIGMA_M, 3))


def _hand_eye(
    truth: tuple[DrawnArm, DrawnOptics, Mounting],
    setup: Setup,
    grade: Grade,
    rng: np.random.Generator,
) -> UncertainPose:
    """Twenty poses around the working one, with the corners of a board."""
    arm, optics, mounting = truth
    believed = CameraModel(optics.believed.matrix, np.zeros(5))
    poses = []
    for number in range(HAND_EYE_POSES):
        commanded = _board_pose(setup, rng)
        place = arm.place(commanded, rng)
        if setup is Setup.EYE_IN_HAND:
            camera_T_board = mounting.flange_T_cam1.inv() * place.inv() * SOCKET
        else:
            camera_T_board = mounting.base_T_cam2.inv() * place * FLANGE_T_PLUG
        pixels = optics.pixels(camera_T_board, _BOARD_M, CORNERS_PX, rng)
        seen, _ = board_in_camera(believed, _BOARD_M, pixels, CORNERS_PX)
        poses.append(HandEyePose(f"pose {number}", commanded, seen))
    # The noise is what the arm's errors scatter, not its repeatability.
    noise = RobotNoise(max(grade.link_m * 1.5, 2e-5), max(grade.link_rad * 3.0, 2e-5))
    result = calibrate_hand_eye(poses, setup, noise=noise)
    return UncertainPose(result.camera.pose, result.camera.covariance * result.chi2_ratio)


def _board_pose(setup: Setup, rng: np.random.Generator) -> RigidTransform:
    """Tilts ± 20°, turns ± 40°, depth ± 20 mm, about the point that the camera looks at."""
    tilt = Rotation.from_euler("xy", rng.uniform(-20, 20, 2), degrees=True)
    turn = Rotation.from_euler("z", rng.uniform(-40, 40), degrees=True)
    about = RigidTransform.from_components(rng.uniform(-5e-3, 5e-3, 3), tilt * turn)
    depth = _pose(0, 0, rng.uniform(-0.02, 0.02))
    if setup is Setup.EYE_IN_HAND:
        over = SOCKET.inv() * base_T_flange_over_socket()
        return SOCKET * depth * about * over
    return PLUG_STATION * depth * about * FLANGE_T_PLUG.inv()


def _moved(
    calibrated: UncertainPose, rng: np.random.Generator, position_m: float, rotation_deg: float
) -> UncertainPose:
    directions = rng.normal(size=(2, 3))
    shift, axis = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    error = RigidTransform.from_components(
        shift * position_m, Rotation.from_rotvec(axis * np.radians(rotation_deg))
    )
    return UncertainPose(calibrated.pose * error, calibrated.covariance)
