"""What the adjustments of one camera and of a head have in common: views of one board."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import compress
from typing import Generic, Self, TypeVar

from scipy.spatial.transform import Rotation

from cellctl.calibration.boards.board import CalibrationBoard
from cellctl.calibration.boards.board_shape import ShapeModes
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
