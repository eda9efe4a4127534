"""The joint adjustment of both cameras of a head, all board poses and the shape of the board.

Unknowns that all views share, in order: those of ``StereoHead.parameter_order``, then those of the
board's shape.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.calibration.boards.board import BoardView
from cellctl.calibration.boards.lens_model import LensModel, longer_terms_prior
from cellctl.calibration.boards.projection import Projection, project
from cellctl.calibration.solvers.bundle import LinearImage
from cellctl.calibration.solvers.views_of_board import BoardPoses, PlacedCorners, ViewsOfBoard
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
        left = self.placed([view.left for view in self.views], state.shape, state)
        right = self.placed([view.right for view in self.views], state.shape, state)
        return list(zip(self._in_left(left, state), self._in_right(right, state), strict=True))

    def _in_left(self, corners: PlacedCorners, state: BundleState) -> list[LinearImage]:
        projection = project(state.left, corners.points_m)
        by_shared = self._by_shared(corners, projection)
        by_shared[:, :, : len(state.left)] = projection.by_camera
        return corners.linearised(projection, by_shared)

    def _in_right(self, corners: PlacedCorners, state: BundleState) -> list[LinearImage]:
        moved = corners.points_m @ state.rotation.T
        seen = project(state.right, moved + state.translation_m)
        projection = replace(seen, by_point=seen.by_point @ state.rotation)
        head, camera = self.head, len(state.left)
        by_shared = self._by_shared(corners, projection)
        by_shared[:, :, camera : 2 * camera] = projection.by_camera
        by_shared[:, :, head - 6 : head - 3] = -seen.by_point @ skews(moved)
        by_shared[:, :, head - 3 : head] = seen.by_point
        return corners.linearised(projection, by_shared)

    def _by_shared(self, corners: PlacedCorners, projection: Projection) -> Array:
        """Derivatives by the board's shape, and space for those by the head."""
        head = np.zeros((len(corners.pixels), 2, self.head))
        return np.concatenate([head, corners.by_shape(projection)], axis=2)

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
