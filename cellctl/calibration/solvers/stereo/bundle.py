"""The joint adjustment of both cameras of a head, all board poses and the shape of the board.

Unknowns that all views share, in order: the 24 of ``PARAMETER_ORDER``, then those of the board's
shape.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.calibration.boards.board import BoardView, Corners
from cellctl.calibration.boards.projection import project
from cellctl.calibration.solvers.bundle import (
    LinearImage,
    by_board_pose,
)
from cellctl.calibration.solvers.views_of_board import BoardPoses, ViewsOfBoard
from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import skews

_HEAD = 24


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class BundleState(BoardPoses):
    """All unknowns."""

    left: Array
    """Nine numbers of ``CAMERA_PARAMETERS``."""
    right: Array
    rotation: Array
    """x_right = rotation @ x_left + translation_m."""
    translation_m: Array
    shape: Array
    """Parameters of the board's shape."""


@dataclass(frozen=True, slots=True, eq=False)
class StereoProblem(ViewsOfBoard[BoardView, BundleState]):
    """Adjusts a ``BundleState``; see ``ProblemOfViews``.

    The covariance has shape (24 + shape, 24 + shape); residuals are pairs, left and right.
    """

    name: str = "stereo"

    @property
    def prior(self) -> Array:
        """Inverse prior variance of each shared unknown, 0 where it is free, shape (s,)."""
        return np.concatenate([np.zeros(_HEAD), 1 / self.modes.sigma**2])

    def offsets(self, state: BundleState) -> Array:
        """Shared unknowns less what the prior expects of them, shape (s,); 0 where free."""
        return np.concatenate([np.zeros(_HEAD), state.shape])

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
        by_shared = np.zeros((len(board_m), 2, _HEAD + shape.shape[2]))
        if is_right:
            moved = in_left @ state.rotation.T
            projection = project(state.right, moved + state.translation_m)
            by_shared[:, :, 9:18] = projection.by_camera
            by_shared[:, :, 18:21] = -projection.by_point @ skews(moved)
            by_shared[:, :, 21:24] = projection.by_point
            projection = replace(projection, by_point=projection.by_point @ state.rotation)
        else:
            projection = project(state.left, in_left)
            by_shared[:, :, :9] = projection.by_camera
        by_shared[:, :, _HEAD:] = projection.by_point @ rotation @ shape
        by_view = by_board_pose(projection, turned)
        return LinearImage(corners.pixels - projection.pixels, by_shared, by_view)

    def moved(self, state: BundleState, shared: Array, views: Array) -> BundleState:
        """The unknowns after a step: ``shared`` of shape (s,), ``views`` of shape (views, 6)."""
        return replace(
            state.views_moved(views),
            left=state.left + shared[:9],
            right=state.right + shared[9:18],
            rotation=Rotation.from_rotvec(shared[18:21]).as_matrix() @ state.rotation,
            translation_m=state.translation_m + shared[21:24],
            shape=state.shape + shared[_HEAD:],
        )
