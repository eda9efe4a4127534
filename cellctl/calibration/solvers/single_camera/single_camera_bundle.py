"""The joint adjustment of one camera, all board poses and the shape of the board.

Unknowns that all views share, in order: the nine of ``CAMERA_PARAMETERS``, then those of the
board's shape.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import compress

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.calibration.boards.board import CameraView, Corners, ShapeModes
from cellctl.calibration.boards.projection import project
from cellctl.calibration.solvers.bundle import (
    LinearImage,
    by_board_pose,
)
from cellctl.calibration.solvers.view_rejection import Mask
from cellctl.geometry.pose import Array

CAMERA = 9
_RADIAL_SIGMA = 1.0
"""Prior of k1, k2 and k3, far wider than any lens that images a board sharply. Behind a long lens
k3 moves no corner by a hundredth of a pixel, and without a prior it would take any value."""
_RADIAL = [4, 5, 8]


@dataclass(frozen=True, slots=True, eq=False)
class CameraBundle:
    """All unknowns."""

    camera: Array
    """Nine numbers of ``CAMERA_PARAMETERS``."""
    shape: Array
    """Parameters of the board's shape."""
    view_rotations: Array
    """camera_R_board, shape (views, 3, 3)."""
    view_translations_m: Array
    """Shape (views, 3)."""


@dataclass(frozen=True, slots=True, eq=False)
class CameraProblem:
    """Adjusts a ``CameraBundle``; see ``ProblemOfViews``.

    The covariance has shape (9 + shape, 9 + shape).
    """

    views: Sequence[CameraView]
    flat_m: Array
    modes: ShapeModes
    name: str = "camera"

    def __len__(self) -> int:
        return len(self.views)

    def of_views(self, chosen: Mask) -> "CameraProblem":
        """The adjustment of the chosen views alone."""
        return replace(self, views=list(compress(self.views, chosen)))

    def state_of_views(self, state: CameraBundle, chosen: Mask) -> CameraBundle:
        """The unknowns of the chosen views alone."""
        return replace(
            state,
            view_rotations=state.view_rotations[chosen],
            view_translations_m=state.view_translations_m[chosen],
        )

    def joined(self, shared: CameraBundle, views: CameraBundle) -> CameraBundle:
        """What the views share from one, the poses of the boards from the other."""
        return replace(
            shared,
            view_rotations=views.view_rotations,
            view_translations_m=views.view_translations_m,
        )

    @property
    def prior(self) -> Array:
        """Inverse prior variance of each shared unknown, 0 where it is free, shape (s,)."""
        camera = np.zeros(CAMERA)
        camera[_RADIAL] = 1 / _RADIAL_SIGMA**2
        return np.concatenate([camera, 1 / self.modes.sigma**2])

    def offsets(self, state: CameraBundle) -> Array:
        """Shared unknowns less what the prior expects of them, shape (s,); 0 where free."""
        # A multiplication by the prior follows, which is 0 where the camera is free.
        return np.concatenate([state.camera, state.shape])

    def linearise(self, state: CameraBundle) -> list[tuple[LinearImage]]:
        """Residuals and derivatives of each image of each view."""
        return [(self._image(view.corners, state, i),) for i, view in enumerate(self.views)]

    def _image(self, corners: Corners, state: CameraBundle, index: int) -> LinearImage:
        shape = self.modes.modes[corners.ids]
        board_m = self.flat_m[corners.ids] + shape @ state.shape
        rotation = state.view_rotations[index]
        turned = board_m @ rotation.T
        projection = project(state.camera, turned + state.view_translations_m[index])
        by_shape = projection.by_point @ rotation @ shape
        by_shared = np.concatenate([projection.by_camera, by_shape], axis=2)
        by_view = by_board_pose(projection, turned)
        return LinearImage(corners.pixels - projection.pixels, by_shared, by_view)

    def moved(self, state: CameraBundle, shared: Array, views: Array) -> CameraBundle:
        """The unknowns after a step: ``shared`` of shape (s,), ``views`` of shape (views, 6)."""
        turns = Rotation.from_rotvec(views[:, 3:]).as_matrix()
        return replace(
            state,
            camera=state.camera + shared[:CAMERA],
            shape=state.shape + shared[CAMERA:],
            view_rotations=turns @ state.view_rotations,
            view_translations_m=state.view_translations_m + views[:, :3],
        )
