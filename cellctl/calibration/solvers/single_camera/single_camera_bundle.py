"""The joint adjustment of one camera, all board poses and the shape of the board.

Unknowns that all views share, in order: those of the camera (``projection``), then those of the
board's shape.
"""

from dataclasses import dataclass, replace

import numpy as np

from cellctl.calibration.boards.board import CameraView, Corners
from cellctl.calibration.boards.lens_model import LensModel, longer_terms_prior
from cellctl.calibration.boards.projection import project
from cellctl.calibration.solvers.bundle import (
    LinearImage,
    by_board_pose,
)
from cellctl.calibration.solvers.views_of_board import BoardPoses, ViewsOfBoard
from cellctl.geometry.pose import Array

_RADIAL_SIGMA = 1.0
"""Prior of k1, k2 and k3, far wider than any lens that images a board sharply. Behind a long lens
k3 moves no corner by a hundredth of a pixel, and without a prior it would take any value."""
_RADIAL = [4, 5, 8]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class CameraBundle(BoardPoses):
    """All unknowns of the calibration of one camera."""

    camera: Array
    """Numbers of the camera, in the order of ``projection``."""
    shape: Array
    """Parameters of the board's shape."""


@dataclass(frozen=True, slots=True, eq=False)
class CameraProblem(ViewsOfBoard[CameraView, CameraBundle]):
    """Adjusts a ``CameraBundle``; see ``ProblemOfViews``.

    The covariance has shape (4 + terms + shape, 4 + terms + shape).
    """

    lens: LensModel = LensModel.FIVE
    name: str = "camera"

    @property
    def prior(self) -> Array:
        """Inverse prior variance of each shared unknown, 0 where it is free, shape (s,)."""
        camera = longer_terms_prior(self.lens.terms)
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
        return replace(
            state.views_moved(views),
            camera=state.camera + shared[: len(state.camera)],
            shape=state.shape + shared[len(state.camera) :],
        )
