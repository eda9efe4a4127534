"""What a process says of the measurements that it makes, for planning where its heads stand.

It needs vision, so whoever only reads a cell file does not load it.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from scipy.spatial.transform import RigidTransform

from cellctl.config.stated.moves import StatedPlace
from cellctl.geometry.pose import Array
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.features.hole import Hole


@dataclass(frozen=True, slots=True, eq=False)
class StatedHead:
    """A stereo head that an arm carries."""

    name: str
    """Name in the cell file."""
    robot: str
    pose: str
    """The taught pose from which it measures, and which is to be planned."""
    camera: StereoHead
    """The head as it was calibrated."""
    flange_T_camera: RigidTransform
    flange_T_views: tuple[RigidTransform, ...] = ()
    """Places of the flange, in its frame at this pose, to which the arm has to go from there: the
    views of the head's calibration."""


@dataclass(frozen=True, slots=True, eq=False)
class StatedPart:
    """A part at one place at which heads measure it, and where the arms stand meanwhile."""

    label: str
    """Name in findings, for example ``deck at the stand-off``."""
    robot: str
    """The robot in whose base ``base_T_part`` is written."""
    base_T_part: RigidTransform
    seen: Mapping[str, tuple[Hole, ...]]
    """The holes that each head measures, by its name."""
    further: tuple[Hole, ...]
    """Holes of the drawing that no head measures so far."""
    others: Mapping[str, StatedPlace]
    """Places of the arms that carry no head."""


@dataclass(frozen=True, slots=True, eq=False)
class StatedMeasurement:
    """Parts that two heads measure from one pose each, and the pose that follows from them."""

    label: str
    heads: tuple[StatedHead, StatedHead]
    """The first one's camera is the frame of all points."""
    parts: tuple[StatedPart, ...]
    """Each must be seen. The pose that counts is that of the last one in the first one."""
    thresholds: Array
    """Thresholds of its components x, y, z (m) and rx, ry, rz (rad), in the axes of the first;
    shape (6,)."""
    share: float
    """Largest standard deviation of a component, as a share of its threshold."""
    between_heads: Array
    """Covariance of where the second head is in the first: calibration, and drift since; (6, 6)."""
    sway_m: float
    """How far an arm sways in one picture: standard deviation across the line of sight."""
    frames: int
    """Pairs of images that a measurement begins with."""
    max_frames: int
