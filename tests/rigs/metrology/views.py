"""What heads see of a part, with its truth: the common ground of the metrology benchmarks."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.uncertain import UncertainPose
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.features.hole import Hole

NOISE_GREY = 2.0
"""Standard deviation of the noise of every image."""


@dataclass(frozen=True, slots=True)
class HeadView:
    """What one head sees of a part, with its truth."""

    head: StereoHead
    holes: tuple[Hole, ...]
    camera_T_part: RigidTransform
    images: tuple[Image, Image]
    truth_px: dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]
    truth_m: dict[str, NDArray[np.float64]]
    blur_px: float


@dataclass(frozen=True, slots=True)
class PartView:
    """One exposure of a part by both heads; the transform between them is exact."""

    views: tuple[HeadView, HeadView]
    c1_T_c2: UncertainPose

    @property
    def holes(self) -> tuple[Hole, ...]:
        """All six, in their order."""
        return self.views[0].holes + self.views[1].holes
