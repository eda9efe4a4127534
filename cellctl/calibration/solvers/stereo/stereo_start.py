"""Start values of a stereo adjustment, and the wrong inputs that are recognised there."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.calibration.boards.board import BoardView, CalibrationBoard, Corners
from cellctl.calibration.solvers.camera_start import start_of_camera
from cellctl.calibration.solvers.stereo.bundle import BundleState
from cellctl.errors.calibration import (
    CalibrationCamerasSwapped,
    CalibrationCameraUpsideDown,
    PairsInconsistent,
)
from cellctl.geometry.pose import Array

_MAX_SPREAD_RAD = 0.035
_MAX_SPREAD_OF_BASELINE = 0.15
"""Views of single cameras agree on the relative pose within this, lenses being hardly known."""
_UPSIDE_DOWN_RAD = np.pi / 2


def start_values(
    views: Sequence[BoardView], board: CalibrationBoard, image_size: tuple[int, int], modes: int
) -> tuple[list[BoardView], BundleState]:
    """Views in a consistent corner order, and a start for the adjustment.

    Raises ``CalibrationCamerasSwapped``, ``CalibrationCameraUpsideDown`` or ``PairsInconsistent``.
    """
    if board.symmetric:
        views = [_same_direction(view, board) for view in views]
    left, left_T_board = start_of_camera([view.left for view in views], board, image_size)
    right, right_T_board = start_of_camera([view.right for view in views], board, image_size)
    relative = [r @ np.linalg.inv(a) for a, r in zip(left_T_board, right_T_board, strict=True)]
    rotation, translation_m = _common_pose([view.name for view in views], np.stack(relative))
    return list(views), BundleState(
        left,
        right,
        rotation,
        translation_m,
        np.zeros(modes),
        np.stack([pose[:3, :3] for pose in left_T_board]),
        np.stack([pose[:3, 3] for pose in left_T_board]),
    )


def _common_pose(names: Sequence[str], relative: Array) -> tuple[Array, Array]:
    """The pose right_T_left that the views agree on."""
    rotations = Rotation.from_matrix(relative[:, :3, :3])
    angles = np.stack([(rotations * one.inv()).magnitude() for one in rotations])
    # The median rotation: a wrongly paired view may be off by any angle and must not pull the
    # start.
    middle = rotations[int(np.argmin(np.median(angles, axis=1)))]
    off_rad = (rotations * middle.inv()).magnitude()
    translation_m = np.median(relative[off_rad <= np.median(off_rad), :3, 3], axis=0)
    off_m = np.linalg.norm(relative[:, :3, 3] - translation_m, axis=1)
    baseline_m = float(np.linalg.norm(translation_m))
    bad = (off_rad > _MAX_SPREAD_RAD) | (off_m > _MAX_SPREAD_OF_BASELINE * baseline_m)
    # A few bad views are left to the adjustment, which rejects them by name. That many mean files
    # that are paired wrongly.
    if bad.mean() > 0.3:
        worst = ", ".join(np.asarray(names)[bad][:8])
        raise PairsInconsistent(f"{bad.sum()} of {len(names)} pairs disagree: {worst}")
    # The cameras of a head look the same way: a turn beyond 90° is an image upside down.
    if middle.magnitude() > _UPSIDE_DOWN_RAD:
        raise CalibrationCameraUpsideDown(
            f"the cameras appear turned by {np.degrees(middle.magnitude()):.0f}° to each other"
        )
    # x_right = R x_left + t: with the right camera on the right side, t points to -x.
    if translation_m[0] > 0 and abs(translation_m[0]) > np.abs(translation_m[1:]).max():
        raise CalibrationCamerasSwapped(
            f"the right camera would stand {translation_m[0] * 1e3:.1f} mm left of the left one"
        )
    rotation: Array = middle.as_matrix()
    return rotation, translation_m


def _same_direction(view: BoardView, board: CalibrationBoard) -> BoardView:
    """Give the right image of a symmetric board the corner order of the left one."""
    left, right = (_row_direction(c, board) for c in (view.left, view.right))
    if left @ right >= 0:
        return view
    last = board.columns * board.rows - 1
    turned = Corners((last - view.right.ids)[::-1], view.right.pixels[::-1])
    return replace(view, right=turned)


def _row_direction(corners: Corners, board: CalibrationBoard) -> Array:
    """Mean direction of the board's x axis in the image."""
    column = corners.ids % board.columns
    centred = column - column.mean()
    direction: Array = centred @ (corners.pixels - corners.pixels.mean(axis=0))
    return direction
