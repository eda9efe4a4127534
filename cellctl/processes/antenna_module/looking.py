"""Takes and measures pictures: several of a scene that stands still, combined to one look."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Generic, Protocol, TypeVar

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.solvers.pose_average import average
from cellctl.cell.guarded_motion.settling import settle
from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.cell.image_faults import naming
from cellctl.cell.lighting.auto_exposure import RunExposures
from cellctl.cell.standstill import require_unmoved
from cellctl.clock import utc_at
from cellctl.geometry.pose import MM, Array, pose_error, pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.interfaces import Camera
from cellctl.interfaces.camera import CameraImage, PixelFormat
from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.antenna_module.connector.connector import Connector
from cellctl.processes.antenna_module.connector.marks import Marks
from cellctl.processes.antenna_module.faults.connector import PixelsNotMeasurable
from cellctl.processes.antenna_module.faults.plugging import LooksDisagree
from cellctl.processes.antenna_module.recipe import Place
from cellctl.processes.antenna_module.vision.measure import measure_connector, measure_marks
from cellctl.processes.antenna_module.vision.measurement import ConnectorMeasurement, MeasuredMarks
from cellctl.processes.antenna_module.vision.plane import ExpectedPlace, PlaneCalibration
from cellctl.records.looks import TakenImage, documents_of_look
from cellctl.records.run_recorder import RunRecorder
from cellctl.vision.camera.depth import eight_bits
from cellctl.vision.camera.single_camera import SingleCamera
from cellctl.workers import VisionWorkers

_MOST_APART_M = 10e-6
"""Frames of a scene that stands still differ by the noise of the image, a micrometre."""
_GREEN = 1


class Measured(Protocol):
    """What a worker has found in one image."""


M = TypeVar("M", bound=Measured)


@dataclass(frozen=True, slots=True, eq=False)
class Seen(Generic[M]):
    """Everything that was measured from one place of the arm."""

    frames: tuple[M, ...]
    """One an image."""
    images: tuple[Image, ...]
    """The measured channel of each, shape (rows, columns)."""
    base_T_flange: RigidTransform
    """Pose of the flange that the arm reported while the images were taken."""
    joints_rad: Array
    time_s: float
    """Time of the last image."""
    look: str = ""
    """Name of the look, by which its raw images are found."""


@dataclass(frozen=True, slots=True)
class Eyes:
    """The cameras of one run, with the arm that must stand still and the record."""

    arm: GuardedRobot
    workers: VisionWorkers
    recorder: RunRecorder | None
    """Where raw images go; None where they are not kept."""
    frames: int
    exposures: RunExposures | None = None
    """Exposures of its cameras; None where they stay as they are."""
    named: Callable[[str], str] = str
    """The name of a look among those of the record, where some of them may come again."""

    async def look(self, name: str, camera: Camera, measure: Callable[[Image], M]) -> Seen[M]:
        """Settle, take the images, measure each in a worker; ``name`` is that of the raw images.

        Raises what ``measure`` raises, ``NotSettled``, ``HeadMoved`` when the arm moved meanwhile,
        and before the first look of a camera the faults of its exposure.
        """
        name = self.named(name)
        await settle(self.arm.guard)
        if self.exposures is not None:
            await self.exposures.find(camera)
        # Taken before the first image and asked again after the last: an image between two
        # different poses belongs to neither.
        state = self.arm.robot.state()
        images, found = [], []
        time_s = state.time_s
        for number in range(1, self.frames + 1):
            taken = await camera.grab()
            image = measured_channel(taken)
            if self.recorder is not None:
                file = image_file(name, number)
                await self.recorder.exposures({file: taken.exposure})
                kept = TakenImage(name, camera.name, utc_at(taken.time_s))
                await self.recorder.add(*documents_of_look(name, {file: kept}, {}))
                self.recorder.raw_image(file, image)
            time_s = taken.time_s
            images.append(image)
            with naming(camera.name):
                found.append(await self.workers.run(measure, image))
        require_unmoved("the arm", self.arm.robot, state.base_T_flange)
        return Seen(
            tuple(found), tuple(images), state.base_T_flange, state.joints_rad, time_s, name
        )


def image_file(name: str, frame: int = 1) -> str:
    """The file of an image of a look, where raw images are kept; frames count from 1."""
    return f"raw/{name}-frame-{frame}.pgm.zst"


def measured_channel(image: CameraImage) -> Image:
    """The one plane of grey values that is measured: green of a colour image (``vision.pixels``).

    Deep cameras are reduced to eight bits, which are finer than the noise of the picture. Raises
    ``PixelsNotMeasurable``.
    """
    colour = image.pixel_format in (PixelFormat.RGB8, PixelFormat.RGB16)
    plane = np.ascontiguousarray(image.pixels[:, :, _GREEN]) if colour else image.pixels
    if image.pixel_format in (PixelFormat.MONO8, PixelFormat.RGB8):
        return np.asarray(plane, dtype=np.uint8)
    # In 16 bits a camera of 12 looks like a dark one: only its driver knows how many count.
    if image.exposure is None:
        raise PixelsNotMeasurable(f"{image.pixel_format.value} without the number of its bits")
    return eight_bits(np.asarray(plane, dtype=np.uint16), image.exposure.bits)


def combined(poses: tuple[UncertainPose, ...]) -> UncertainPose:
    """The mean of one pose as the frames show it, as uncertain as a single one.

    What limits a frame is not its noise but the drawing, the light and the plane, which are the
    same in all of them. Raises ``LooksDisagree`` when one is off the mean: something moved.
    """
    mean, _ = average(poses)
    apart_m = max(float(np.linalg.norm(pose_error(mean.pose, one.pose)[0])) for one in poses)
    if apart_m > _MOST_APART_M:
        raise LooksDisagree(f"{len(poses)} images, one is {apart_m * 1e6:.1f} µm off their mean")
    return UncertainPose(mean.pose, poses[0].covariance)


def height_by_size(base_T_camera: RigidTransform, frames: tuple[MeasuredMarks, ...]) -> float:
    """Height of marks along z of the base, by how large they look: the mean of the frames, m."""
    heights_m = [(base_T_camera * one.camera_T_marks_by_size).translation[2] for one in frames]
    return float(np.mean(heights_m))


def plane_by(
    camera: SingleCamera, camera_T_connector: RigidTransform, place: Place
) -> PlaneCalibration:
    """The plane of a connector that lies as ``camera_T_connector`` says, z towards the camera."""
    return PlaneCalibration(
        camera_id=camera.id,
        camera_T_plane=camera_T_connector,
        sigma_height_m=place.height_sigma_mm * MM,
        sigma_tilt_rad=float(np.radians(place.tilt_sigma_deg)),
        expected=ExpectedPlace(
            camera_T_connector, place.within_mm * MM, float(np.radians(place.within_deg))
        ),
    )


def marks_by(
    model: SingleCamera, marks: Marks, camera_T_marks: RigidTransform, place: Place
) -> Callable[[Image], MeasuredMarks]:
    """``measure_marks`` for an image where they are expected so, as certain as ``place`` says."""
    calibration = plane_by(model, camera_T_marks, place)
    return partial(measure_marks, camera=model, calibration=calibration, marks=marks)


def connector_by(
    model: SingleCamera,
    connector: Connector,
    camera_T_connector: RigidTransform,
    place: Place,
    marks: Marks | None = None,
) -> Callable[[Image], ConnectorMeasurement]:
    """``measure_connector`` in the same way; ``marks``: of the gripper in the same image."""
    calibration = plane_by(model, camera_T_connector, place)
    return partial(
        measure_connector, camera=model, calibration=calibration, connector=connector, marks=marks
    )


def nominal(place: Place) -> RigidTransform:
    """The pose of a place by the drawing."""
    return pose_from_xyzabc(place.pose)
