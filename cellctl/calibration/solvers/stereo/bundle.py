"""The joint adjustment of both cameras of a head, all board poses and the shape of the board.

Unknowns that all views share, in order: those of ``StereoHead.parameter_order``, then those of the
board's shape.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.calibration.boards.board import BoardView, Corners
from cellctl.calibration.boards.lens_model import LensModel, longer_terms_prior
from cellctl.calibration.boards.projection import project
from cellctl.calibration.solvers.bundle import (
    LinearImage,
    by_board_pose,
)
from cellctl.calibration.solvers.views_of_board import BoardPoses, ViewsOfBoard
from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import skews


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class BundleState(BoardPoses):
    """All unknowns of the calibration of a head."""

    left: Array
    """Numbers of the left camera, in the order of ``projection``."""
    right: Array
    rotation: Array
    """x_right = rotation @ x_left + translation_m."""
    translation_m: Array
    shape: Array
    """Parameters of the board's shape."""


@dataclass(frozen=True, slots=True, eq=False)
class StereoProblem(ViewsOfBoard[BoardView, BundleState]):
    """Adjusts a ``BundleState``; see ``ProblemOfViews``.

    The covariance has shape (head + shape, head + shape); residuals are pairs, left and right.
    """

    lens: LensModel = LensModel.FIVE
    name: str = "stereo"

    @property
    def head(self) -> int:
        """Unknowns of the head: of both cameras, of rotation and translation."""
        return 2 * (4 + self.lens.terms) + 6

    @property
    def prior(self) -> Array:
        """Inverse prior variance of each shared unknown, 0 where it is free, shape (s,)."""
        camera = longer_terms_prior(self.lens.terms)
        return np.concatenate([camera, camera, np.zeros(6), 1 / self.modes.sigma**2])

    def offsets(self, state: BundleState) -> Array:
        """Shared unknowns less what the prior expects of them, shape (s,); 0 where free."""
        # A multiplication by the prior follows, which is 0 where the cameras are free.
        return np.concatenate([state.left, state.right, np.zeros(6), state.shape])

    def linearise(self, state: BundleState) -> list[tuple[LinearImage, ...]]:
        """Residuals and derivatives of each image of each view."""
        return [
            (
                self._image(view.left, state, index, is_right=False),
                self._image(view.right, state, index, is_right=True),
            )
            for index, view in enumerate(self.views)
        ]

    def _image(
        self, corners: Corners, state: BundleState, index: int, *, is_right: bool
    ) -> LinearImage:
        shape = self.modes.modes[corners.ids]
        board_m = self.flat_m[corners.ids] + shape @ state.shape
        rotation = state.view_rotations[index]
        turned = board_m @ rotation.T
        in_left = turned + state.view_translations_m[index]
        head, camera = self.head, len(state.left)
        by_shared = np.zeros((len(board_m), 2, head + shape.shape[2]))
        if is_right:
            moved = in_left @ state.rotation.T
            projection = project(state.right, moved + state.translation_m)
            by_shared[:, :, camera : 2 * camera] = projection.by_camera
            by_shared[:, :, head - 6 : head - 3] = -projection.by_point @ skews(moved)
            by_shared[:, :, head - 3 : head] = projection.by_point
            projection = replace(projection, by_point=projection.by_point @ state.rotation)
        else:
            projection = project(state.left, in_left)
            by_shared[:, :, :camera] = projection.by_camera
        by_shared[:, :, head:] = projection.by_point @ rotation @ shape
        by_view = by_board_pose(projection, turned)
        return LinearImage(corners.pixels - projection.pixels, by_shared, by_view)

    def moved(self, state: BundleState, shared: Array, views: Array) -> BundleState:
        """The unknowns after a step: ``shared`` of shape (s,), ``views`` of shape (views, 6)."""
        head, camera = self.head, len(state.left)
        return replace(
            state.views_moved(views),
            left=state.left + shared[:camera],
            right=state.right + shared[camera : 2 * camera],
            rotation=Rotation.from_rotvec(shared[head - 6 : head - 3]).as_matrix() @ state.rotation,
            translation_m=state.translation_m + shared[head - 3 : head],
            shape=state.shape + shared[head:],
        )
