"""Where a part lies that looks the same after half a turn, as the target board does."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.vision.features.hole import Hole
from cellctl.vision.holes.correspondence import COARSE_TOLERANCE_M, Assignment, assignments
from cellctl.vision.holes.diagnose import fault_without_layout
from cellctl.vision.holes.search import NEAR, WIDE, HeadImages, WholeImageSearch
from cellctl.vision.registration.rigid_fit import kabsch


def pose_turned_like(
    images: HeadImages, holes: Sequence[Hole], camera_T_part: RigidTransform
) -> RigidTransform:
    """Coarse ``camera_T_part`` (left camera) of a part that lies anywhere in both images.

    Of the poses that fit it is the one that is turned most like ``camera_T_part``, whose place does
    not count: for a part with half-turn symmetry a pose that is right to 90 degrees. Raises
    ``HoleMissing``, ``CamerasSwapped`` or ``CameraUpsideDown``.
    """
    search = WholeImageSearch(images, holes)
    for reach in (NEAR, WIDE):
        candidates = search.features(reach).pairs()
        found = assignments(holes, candidates, tolerance_m=COARSE_TOLERANCE_M, expectation=None)
        if found:
            back = camera_T_part.rotation.inv()
            poses = [_pose(holes, one) for one in found]
            return min(poses, key=lambda pose: (back * pose.rotation).magnitude())
    raise fault_without_layout(search, candidates, None)


def _pose(holes: Sequence[Hole], found: Assignment) -> RigidTransform:
    drawing = np.array([hole.position_m for hole in holes])
    rotation, translation_m = kabsch(drawing, found.positions_m)
    return RigidTransform.from_components(translation_m, Rotation.from_matrix(rotation))
