"""What a camera sees: the hand-over from the world to the renderer.

Everything is truth, in SI units. A pose ``camera_T_x`` is given in the frame of the camera, which
for a stereo head is its left one: z forward, x right, y down. Parts and boards have z pointing out
of their visible face, towards the camera.
"""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from fakes.scenario_file.sections import RingLamp
from fakes.world.connector.scene import SceneConnector, SceneMarks

Array = NDArray[np.float64]
HoleKind = Literal["pin", "thread", "countersink"]
Side = Literal["left", "right"]


@dataclass(frozen=True, slots=True)
class LensTruth:
    """One camera as it really is."""

    focal_px: tuple[float, float]
    centre_px: tuple[float, float]
    """Pixel centres lie at integers."""
    distortion: tuple[float, float, float, float, float]
    """k1, k2, p1, p2, k3 of the usual polynomial model, normalised coordinates."""
    blur_px: float
    """Standard deviation of the optical blur, before the pixel's own box."""
    gain: float
    """Brightness of this camera relative to nominal."""
    misfit: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Waves that the polynomial model cannot follow: amplitude in normalised coordinates, phases
    along x and y."""


@dataclass(frozen=True, slots=True)
class StereoTruth:
    """Both cameras of a head."""

    image_size_px: tuple[int, int]
    """Width, height."""
    left: LensTruth
    right: LensTruth
    right_T_left: RigidTransform
    """``x_right = right_T_left.apply(x_left)``."""


@dataclass(frozen=True, slots=True)
class MonoTruth:
    """A single camera."""

    image_size_px: tuple[int, int]
    """Width, height."""
    lens: LensTruth
    colour: bool


@dataclass(frozen=True, slots=True)
class SceneHole:
    """A hole as it was really made, in the frame of its part; its rim lies at z = 0."""

    name: str
    kind: HoleKind
    position_m: tuple[float, float]
    diameter_m: float
    """The rim that carries the centre: pin bore, thread bore, or bore of a countersunk hole."""
    countersink_m: float | None
    """Diameter of the outer rim of the countersink."""
    depth_m: float
    """Depth of the visible wall."""
    through: bool
    thread_begins_rad: float = 0.0
    """Azimuth in the part at which the first turn of a thread comes up."""


@dataclass(frozen=True, slots=True)
class ScenePlate:
    """A flat part with holes; its frame lies in the middle of the face that is seen."""

    name: str
    camera_T_part: RigidTransform
    size_m: tuple[float, float]
    thickness_m: float
    """Thickness of the sides that one sees past its edges."""
    holes: tuple[SceneHole, ...]
    seed: int
    """Seed of texture, scratches and false circles, which stay on the part for the whole run."""
    brightness: float = 1.0
    """Brightness of its face and sides, relative to the bare metal of the rendering."""


@dataclass(frozen=True, slots=True)
class SceneDisc:
    """A white disc of the target board, in the plane z = 0 of the board."""

    name: str
    position_m: tuple[float, float]


@dataclass(frozen=True, slots=True)
class SceneTargetBoard:
    """Dark plate with white discs; origin in its middle."""

    camera_T_board: RigidTransform
    size_m: tuple[float, float]
    disc_diameter_m: float
    discs: tuple[SceneDisc, ...]
    seed: int


@dataclass(frozen=True, slots=True)
class SceneChessboard:
    """Printed chessboard, slightly bowed; origin in the middle of the printed field.

    The inner corners lie on a grid with ``square_m`` pitch, symmetric about the origin. A point
    (x, y) of the print has the height z = bow_x (1 - (x/a)²) + bow_y (1 - (y/b)²), where a and b
    are half the sides of the plate.
    """

    camera_T_board: RigidTransform
    inner_corners: tuple[int, int]
    """Number of corners along x and along y."""
    square_m: float
    size_m: tuple[float, float]
    bow_m: tuple[float, float]
    seed: int


Body = ScenePlate | SceneTargetBoard | SceneChessboard
"""What the renderer of plates and boards draws."""
Seen = Body | SceneConnector | SceneMarks
"""Whatever a scene can show to a camera. Where connectors or marks are in view, they alone are
drawn."""


@dataclass(frozen=True, slots=True)
class Exposure:
    """What distinguishes one exposure of a scene from the next, beside noise."""

    sway_rad: tuple[float, float] = (0.0, 0.0)
    """Angle of the line of sight in the middle of the exposure, towards +x and +y of the
    image as the picture moves."""
    smear_rad: tuple[float, float] = (0.0, 0.0)
    """Standard deviation of its motion during the exposure."""
    gain: float = 1.0
    """Brightness relative to that of the scene."""


@dataclass(frozen=True, slots=True)
class CameraScene:
    """One exposure of one camera or stereo head."""

    camera: str
    time_s: float
    optics: StereoTruth | MonoTruth
    bodies: tuple[Seen, ...]
    """Bodies in any order: nearer ones hide farther ones."""
    light_seed: int
    """Direction of the light gradient; fixed for the camera in one run."""
    noise_seed: int
    """Sensor noise; differs from exposure to exposure."""
    exposure: Exposure = Exposure()
    lamp: RingLamp = field(default_factory=RingLamp)
