"""The camera of a drawn cell whose looks are rendered images, measured by the package.

It takes the place of ``DrawnOptics`` and draws the same chances, so that a cell's plugs can be
plugged both ways and compared one by one. The constant error that ``DrawnOptics`` draws for light
and chamfers is not drawn here: lamps and shapes of the rendered contacts make their own.
"""

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform

from benchmarks.antenna.chain.drawn_cell import MARKS_M, DrawnCell
from benchmarks.antenna.chain.optics import (
    PLANE_SIGMA_M,
    TILT_SIGMA_RAD,
    DrawnOptics,
    Intrinsics,
    Sight,
)
from benchmarks.antenna.chain.trials import CONTACTS_M
from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import UncertainPose
from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.antenna_module.connector.connector import Connector, read_connector
from cellctl.processes.antenna_module.connector.marks import Marks, read_marks
from cellctl.processes.antenna_module.vision.measure import measure_connector, measure_marks
from cellctl.processes.antenna_module.vision.plane import (
    ExpectedPlace,
    PlaneCalibration,
    facing_camera,
)
from cellctl.vision.camera.single_camera import SingleCamera
from cellctl.vision.camera.stereo_head import CameraModel
from fakes.render.connectors import api
from fakes.world.connector.drawing import SOCKET_T_MATED_PLUG, ContactKind
from fakes.world.connector.scene import ConnectorBody
from fakes.world.scene import LensTruth, MonoTruth

_FOLDER = Path("config/connectors")
_NAME = "micro-d-15"
_BLUR_PX = 0.9
_LAMPS = api.Lamps(one_sided=0.3)
_CONNECTOR_M, _MARKS_FIELD_M = (0.019, 0.011), (0.058, 0.026)
"""Part of the picture that is rendered: what is looked at, wherever grip and mounting put it."""
_WITHIN_M, _WITHIN_RAD = 4e-3, float(np.radians(4.0))


@dataclass(frozen=True, slots=True, eq=False)
class ImageOptics:
    """One camera that sees contacts of one kind, and gripper marks."""

    drawn: DrawnOptics
    kind: ContactKind
    chance: np.random.Generator
    """Chance for noise and light of the images: the cell's own must not depend on them."""

    def look(self, sight: Sight, rng: np.random.Generator) -> UncertainPose:
        """As ``DrawnOptics.look``; raises the faults of the measurement.

        Contacts and marks are rendered. Everything else is as drawn: the scheme that is compared
        does not use it.
        """
        drawn = self.drawn.look(sight, rng)
        if sight.points_m is MARKS_M:
            return self._marks(sight)
        return self._connector(sight) if sight.points_m is CONTACTS_M else drawn

    def _connector(self, sight: Sight) -> UncertainPose:
        flip = _flip(self.kind)
        body = api.connector_as_made(
            _NAME,
            self.kind,
            seed=self._seed(),
            camera_T_connector=sight.camera_T_object * flip,
            # The truth of the campaign is the drawing's frame; how well that is fitted to contacts
            # off their places is the affair of the benchmarks of the vision.
            true_position_m=0.0,
        )
        look = self._shown(body, sight.believed_plane, flip, _CONNECTOR_M)
        found = measure_connector(look.image, look.model, look.plane, _connector(self.kind))
        return _turned(found.camera_T_connector, flip)

    def _marks(self, sight: Sight) -> UncertainPose:
        flip = _flip("pins")
        body = api.gripper_marks(sight.camera_T_object * flip)
        look = self._shown(body, sight.believed_plane, flip, _MARKS_FIELD_M)
        found = measure_marks(look.image, look.model, look.plane, _marks())
        return _turned(found.camera_T_marks, flip)

    def _shown(
        self,
        body: ConnectorBody,
        believed_plane: RigidTransform,
        flip: RigidTransform,
        sides_m: tuple[float, float],
    ) -> "_Shown":
        """The image of a body by the true camera, and what the believed one says of it."""
        window = _Window.about(self.drawn, believed_plane, sides_m)
        camera, look = window.camera(self.drawn.true), api.ConnectorLook(_LAMPS)
        image = api.render(camera, (body,), look, seed=self._seed()).image
        model = window.model(self.drawn.believed)
        return _Shown(image, model, _plane(model, believed_plane, believed_plane * flip))

    def _seed(self) -> int:
        return int(self.chance.integers(2**31))


def with_images(cell: DrawnCell, seed: int) -> DrawnCell:
    """The same cell with cameras that take images."""
    drawn1, drawn2 = cell.optics1, cell.optics2
    assert isinstance(drawn1, DrawnOptics)
    assert isinstance(drawn2, DrawnOptics)
    return replace(
        cell,
        optics1=ImageOptics(drawn1, "holes", np.random.default_rng([seed, 11])),
        optics2=ImageOptics(drawn2, "pins", np.random.default_rng([seed, 12])),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Shown:
    """An image with all that it is measured by."""

    image: Image
    model: SingleCamera
    plane: PlaneCalibration


@dataclass(frozen=True, slots=True, eq=False)
class _Window:
    """A part of the sensor, as a camera of its own: the same lens, another principal point."""

    corner_px: Array
    size_px: tuple[int, int]

    @classmethod
    def about(
        cls, drawn: DrawnOptics, camera_T_middle: RigidTransform, sides_m: tuple[float, float]
    ) -> "_Window":
        """Round where something is believed to be, its longer side along the rows of contacts."""
        x, y, z = camera_T_middle.translation
        middle = drawn.believed.focal_px * np.array([x, y]) / z + drawn.believed.centre_px
        # Rows of contacts may lie along either axis of the image.
        lies = np.abs(camera_T_middle.rotation.as_matrix()[:2, 0])
        along, across = sides_m if lies[0] > lies[1] else sides_m[::-1]
        size = [round(side / z * drawn.believed.focal_px) for side in (along, across)]
        corner = np.round(middle - np.array(size) / 2.0)
        return cls(corner, (size[0], size[1]))

    def camera(self, true: Intrinsics) -> MonoTruth:
        """The camera as it is."""
        u, v = true.centre_px - self.corner_px
        focal = (true.focal_px, true.focal_px)
        lens = LensTruth(focal, (float(u), float(v)), (0.0,) * 5, _BLUR_PX, 1.0)
        return MonoTruth(self.size_px, lens, colour=False)

    def model(self, believed: Intrinsics) -> SingleCamera:
        """The camera as it is believed to be."""
        shifted = replace(believed, centre_px=believed.centre_px - self.corner_px)
        return SingleCamera(self.size_px, CameraModel(shifted.matrix, np.zeros(5)))


def _plane(
    model: SingleCamera, believed_plane: RigidTransform, expected: RigidTransform
) -> PlaneCalibration:
    place = ExpectedPlace(expected, _WITHIN_M, _WITHIN_RAD)
    facing = facing_camera(believed_plane)
    return PlaneCalibration(model.id, facing, PLANE_SIGMA_M, TILT_SIGMA_RAD, place)


def _flip(kind: ContactKind) -> RigidTransform:
    """The turn from the campaign's frame, z up, to the drawing's, z out of the mating face."""
    return RigidTransform.identity() if kind == "holes" else SOCKET_T_MATED_PLUG


def _turned(seen: UncertainPose, flip: RigidTransform) -> UncertainPose:
    # The origin stays, and covariances are in the axes of the camera.
    return UncertainPose(seen.pose * flip.inv(), seen.covariance)


@cache
def _connector(kind: ContactKind) -> Connector:
    return read_connector(_FOLDER / f"{_NAME}-{kind}.toml")


@cache
def _marks() -> Marks:
    return read_marks(_FOLDER / "gripper.toml")
