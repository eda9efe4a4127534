"""Where a part lies that looks the same after half a turn, as the target board does."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.vision.features.hole import Hole
from cellctl.vision.holes.arrangements import arrangements
from cellctl.vision.holes.correspondence import Assignment
from cellctl.vision.holes.search import HeadImages
from cellctl.vision.registration.rigid_fit import kabsch


def pose_turned_like(
    images: HeadImages, holes: Sequence[Hole], camera_T_part: RigidTransform
) -> RigidTransform:
    """Coarse ``camera_T_part`` (left camera) of a part that lies anywhere in both images.

    Of the poses that fit it is the one that is turned most like ``camera_T_part``, whose place does
    not count: for a part with half-turn symmetry a pose that is right to 90 degrees. Raises
    ``HoleMissing``, ``CamerasSwapped`` or ``CameraUpsideDown``.
    """
    back = camera_T_part.rotation.inv()
    poses = [_pose(holes, one) for one in arrangements(images, holes, None)]
    return min(poses, key=lambda pose: (back * pose.rotation).magnitude())


def _pose(holes: Sequence[Hole], found: Assignment) -> RigidTransform:
    drawing = np.array([hole.position_m for hole in holes])
    rotation, translation_m = kabsch(drawing, found.positions_m)
    return RigidTransform.from_components(translation_m, Rotation.from_matrix(rotation))
