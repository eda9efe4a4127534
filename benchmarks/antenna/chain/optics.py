"""Points into pixels by the true camera, and back into a pose in a known plane by the believed one.

The believed camera is wrong by what a calibration leaves, and stays so from the hand-eye
calibration to the last look. The fit is the shortest one possible, not the package's: what images
add to it is measured by the benchmarks of the vision.
"""

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import UncertainPose

FOCAL_PX = 25.0 / 3.45e-3
CENTRE_PX = (1224.0, 1024.0)
WORKING_DISTANCE_M = 0.25
PLANE_SIGMA_M = 0.2e-3
TILT_SIGMA_RAD = float(np.radians(0.1))


@dataclass(frozen=True, slots=True, eq=False)
class Intrinsics:
    """A camera without distortion: what is left of that after calibration is noise here."""

    focal_px: float
    centre_px: Array

    @property
    def matrix(self) -> Array:
        """Camera matrix, shape (3, 3)."""
        u, v = self.centre_px
        return np.array([[self.focal_px, 0.0, u], [0.0, self.focal_px, v], [0.0, 0.0, 1.0]])


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """What stands before a camera, and what is believed of it."""

    camera_T_object: RigidTransform
    points_m: Array
    """Points of the object, shape (n, 3) with z = 0."""
    believed_plane: RigidTransform
    """camera_T_plane: the object is believed to lie in its x-y plane."""
    noise_px: float
    """Standard deviation with which a point is found, per axis."""


class Optics(Protocol):
    """One camera of a drawn cell."""

    def look(self, sight: Sight, rng: np.random.Generator) -> UncertainPose:
        """camera_T_object from one image, see ``DrawnOptics``."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class DrawnOptics:
    """One camera, as it is and as it is believed to be."""

    true: Intrinsics
    believed: Intrinsics
    bias_m: Array
    """What light and chamfers move every contact by, along x and y of the camera."""

    @classmethod
    def draw(cls, rng: np.random.Generator, bias_m: float) -> "DrawnOptics":
        """Principal point 1 px and focal length 1e-4 wrong, per axis."""
        true = Intrinsics(FOCAL_PX, np.array(CENTRE_PX))
        believed = replace(
            true,
            focal_px=FOCAL_PX * (1 + rng.normal(0, 1e-4)),
            centre_px=true.centre_px + rng.normal(0, 1.0, 2),
        )
        return cls(true, believed, rng.normal(0, bias_m, 2))

    def pixels(
        self,
        camera_T_object: RigidTransform,
        points_m: Array,
        noise_px: float,
        rng: np.random.Generator,
    ) -> Array:
        """Where points of an object are found in the image, shape (n, 2)."""
        seen = camera_T_object.apply(points_m)
        flat = seen[:, :2] / seen[:, 2:]
        exact = self.true.focal_px * flat + self.true.centre_px
        return np.asarray(exact + rng.normal(0, noise_px, exact.shape))

    def look(self, sight: Sight, rng: np.random.Generator) -> UncertainPose:
        """The object's pose from one image, in the plane where it is believed to lie."""
        believed_plane = sight.believed_plane
        pixels = self.pixels(sight.camera_T_object, sight.points_m, sight.noise_px, rng)
        pixels = pixels + self.bias_m / WORKING_DISTANCE_M * self.true.focal_px
        flat = (pixels - self.believed.centre_px) / self.believed.focal_px
        rays = np.column_stack([flat, np.ones(len(flat))])
        normal = believed_plane.rotation.as_matrix()[:, 2]
        scale = (normal @ believed_plane.translation) / (rays @ normal)
        found = believed_plane.inv().apply(rays * scale[:, None])[:, :2]
        plane_T_object = _rigid_fit(sight.points_m[:, :2], found)
        sigma_m = sight.noise_px / self.believed.focal_px * WORKING_DISTANCE_M
        return UncertainPose(believed_plane * plane_T_object, _covariance(sight.points_m, sigma_m))


def _rigid_fit(drawing: Array, found: Array) -> RigidTransform:
    """The turn and shift in the plane that take the drawing to what was found."""
    a, b = drawing - drawing.mean(axis=0), found - found.mean(axis=0)
    yaw = np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a * b).sum())
    turn = Rotation.from_euler("z", yaw)
    shift = np.append(found.mean(axis=0), 0.0) - turn.apply(np.append(drawing.mean(axis=0), 0.0))
    return RigidTransform.from_components(shift, turn)


def _covariance(points_m: Array, sigma_m: float) -> Array:
    spread = float(((points_m - points_m.mean(axis=0)) ** 2).sum())
    return np.diag(
        [
            *[sigma_m**2 / len(points_m)] * 2,
            PLANE_SIGMA_M**2,
            *[TILT_SIGMA_RAD**2] * 2,
            sigma_m**2 / spread,
        ]
    )
