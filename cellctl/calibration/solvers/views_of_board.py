"""What the adjustments of one camera and of a head have in common: views of one board."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import compress, pairwise
from typing import Generic, Self, TypeVar

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.calibration.boards.board import CalibrationBoard, Corners
from cellctl.calibration.boards.board_shape import ShapeModes
from cellctl.calibration.boards.projection import Projection
from cellctl.calibration.solvers.bundle import LinearImage, by_board_pose
from cellctl.calibration.solvers.view_rejection import Mask
from cellctl.geometry.pose import Array


def turn_warnings(board: CalibrationBoard) -> tuple[str, ...]:
    """What a board costs that looks the same after a turn."""
    if len(board.quarter_turns) == 1:
        return ()
    return (
        f"the {board} looks the same when it is turned: of its shape only what does so too "
        "could be released",
    )


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class BoardPoses:
    """The unknowns of each view: the pose of the board in its first camera."""

    view_rotations: Array
    """camera_R_board, shape (views, 3, 3)."""
    view_translations_m: Array
    """Shape (views, 3)."""

    def views_moved(self, views: Array) -> Self:
        """These views after a step of shape (views, 6): shift in m, turn as a rotation vector in
        rad."""
        turns = Rotation.from_rotvec(views[:, 3:]).as_matrix()
        return replace(
            self,
            view_rotations=turns @ self.view_rotations,
            view_translations_m=self.view_translations_m + views[:, :3],
        )


@dataclass(frozen=True, slots=True, eq=False)
class PlacedCorners:
    """The corners that one camera saw in all views, view after view, where the unknowns have them.

    All in one array: an image has some fifty corners, and for so few the calls of an adjustment of
    each image by itself take longer than the numbers.
    """

    pixels: Array
    """Measured, shape (n, 2)."""
    counts: Sequence[int]
    """Corners in each view."""
    rotations: Array
    """camera_R_board of each corner, shape (n, 3, 3)."""
    shape: Array
    """Derivative of its place on the board by the board's shape, m, shape (n, 3, k)."""
    turned_m: Array
    """Turned into the first camera's frame but not yet shifted, shape (n, 3)."""
    points_m: Array
    """In the first camera's frame, shape (n, 3)."""

    def by_shape(self, projection: Projection) -> Array:
        """Derivative of a projection by the board's shape, shape (n, 2, k)."""
        return projection.by_point @ self.rotations @ self.shape

    def linearised(self, projection: Projection, by_shared: Array) -> list[LinearImage]:
        """The image of each view, of the projections of all; ``by_shared`` has shape (n, 2, s)."""
        residuals = self.pixels - projection.pixels
        by_view = by_board_pose(projection, self.turned_m)
        ends = np.cumsum([0, *self.counts]).tolist()
        return [
            LinearImage(residuals[begin:end], by_shared[begin:end], by_view[begin:end])
            for begin, end in pairwise(ends)
        ]


V = TypeVar("V")
S = TypeVar("S", bound=BoardPoses)


@dataclass(frozen=True, slots=True, eq=False)
class ViewsOfBoard(Generic[V, S]):
    """Views of one board, of which some may be left out; unknowns are of type ``S``."""

    views: Sequence[V]
    flat_m: Array
    """The corners on an even board, shape (n, 3)."""
    modes: ShapeModes

    def __len__(self) -> int:
        return len(self.views)

    def of_views(self, chosen: Mask) -> Self:
        """The adjustment of the chosen views alone."""
        return replace(self, views=list(compress(self.views, chosen)))

    def state_of_views(self, state: S, chosen: Mask) -> S:
        """The unknowns of the chosen views alone."""
        return replace(
            state,
            view_rotations=state.view_rotations[chosen],
            view_translations_m=state.view_translations_m[chosen],
        )

    def joined(self, shared: S, views: S) -> S:
        """What the views share from one, the poses of the boards from the other."""
        return replace(
            shared,
            view_rotations=views.view_rotations,
            view_translations_m=views.view_translations_m,
        )

    def placed(self, images: Sequence[Corners], shape: Array, state: S) -> PlacedCorners:
        """The corners of ``images``, one for each view, on a board of ``shape``, shape (k,)."""
        ids = np.concatenate([corners.ids for corners in images])
        counts = [len(corners.ids) for corners in images]
        modes = self.modes.modes[ids]
        rotations = np.repeat(state.view_rotations, counts, axis=0)
        board_m = self.flat_m[ids] + modes @ shape
        turned_m = (rotations @ board_m[:, :, None])[:, :, 0]
        return PlacedCorners(
            pixels=np.concatenate([corners.pixels for corners in images]),
            counts=counts,
            rotations=rotations,
            shape=modes,
            turned_m=turned_m,
            points_m=turned_m + np.repeat(state.view_translations_m, counts, axis=0),
        )
