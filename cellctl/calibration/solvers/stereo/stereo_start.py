"""Start values of a stereo adjustment, and the wrong inputs that are recognised there."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.calibration.boards.board import BoardView, CalibrationBoard, Corners
from cellctl.calibration.boards.lens_model import LensModel
from cellctl.calibration.solvers.camera_start import start_of_camera
from cellctl.calibration.solvers.stereo.bundle import BundleState
from cellctl.calibration.solvers.view_rejection import Mask, repeated
from cellctl.errors.calibration import (
    CalibrationCamerasSwapped,
    CalibrationCameraUpsideDown,
    CameraSeenTwice,
    PairsInconsistent,
)
from cellctl.geometry.pose import Array

_MAX_SPREAD_RAD = 0.035
_MAX_SPREAD_OF_BASELINE = 0.15
"""Views of single cameras agree on the relative pose within this, lenses being hardly known."""
_UPSIDE_DOWN_RAD = np.pi / 2
_MAX_BAD = 0.3
"""Largest share of pairs that disagree with the others."""


@dataclass(frozen=True, slots=True, eq=False)
class StereoStart:
    """The values at which the adjustment of a head begins."""

    views: list[BoardView]
    """The views, with their corners in one order left and right."""
    state: BundleState
    plausible: Mask
    """Views whose two pictures agree with those of the others, shape (views,)."""
    excluded: Mask
    """Views that are there already."""
    doubts: Mapping[int, str]
    """Why views are not plausible, or excluded."""


def start_values(
    views: Sequence[BoardView],
    board: CalibrationBoard,
    image_size: tuple[int, int],
    modes: int,
    lens: LensModel,
) -> StereoStart:
    """Views in a consistent corner order, and a start for the adjustment.

    Raises ``CalibrationCamerasSwapped``, ``CalibrationCameraUpsideDown``, ``CameraSeenTwice``,
    ``PairsInconsistent`` or ``SolveFailed``.
    """
    if all(_same(view.left, view.right) for view in views):
        raise CameraSeenTwice(f"in all {len(views)} pairs the right image is the left one")
    if len(board.quarter_turns) > 1:
        views = [_same_direction(view, board) for view in views]
    left = start_of_camera([view.left for view in views], board, image_size)
    right = start_of_camera([view.right for view in views], board, image_size)
    relative = np.stack(
        [
            right_T_board @ np.linalg.inv(left_T_board)
            for left_T_board, right_T_board in zip(
                left.camera_T_board, right.camera_T_board, strict=True
            )
        ]
    )
    fits = left.fits & right.fits
    rotation, translation_m, doubts = _common_pose([view.name for view in views], relative, fits)
    for side, start in (("left", left), ("right", right)):
        for misfit in np.flatnonzero(~start.fits):
            doubts[int(misfit)] = f"the {side} camera cannot have taken it together with the others"
    excluded = np.zeros(len(views), dtype=np.bool_)
    for index, (earlier, sides) in _repeated_pairs(views).items():
        excluded[index] = len(sides) == 2
        pictures = "pictures are those" if excluded[index] else "picture is that"
        doubts[index] = f"its {' and '.join(sides)} {pictures} of {views[earlier].name}"
    plausible = np.array([index not in doubts for index in range(len(views))])
    state = BundleState(
        left=left.with_terms(lens.terms),
        right=right.with_terms(lens.terms),
        rotation=rotation,
        translation_m=translation_m,
        shape=np.zeros(modes),
        view_rotations=np.stack([pose[:3, :3] for pose in left.camera_T_board]),
        view_translations_m=np.stack([pose[:3, 3] for pose in left.camera_T_board]),
    )
    seen = [
        BoardView(view.name, one, other)
        for view, one, other in zip(views, left.images, right.images, strict=True)
    ]
    return StereoStart(seen, state, plausible, excluded, doubts)


def _repeated_pairs(views: Sequence[BoardView]) -> dict[int, tuple[int, list[str]]]:
    """Views with pictures of an earlier one: which one, and on which sides."""
    found: dict[int, tuple[int, list[str]]] = {}
    for side, images in (
        ("left", [view.left for view in views]),
        ("right", [view.right for view in views]),
    ):
        for index, earlier in repeated(images).items():
            found.setdefault(index, (earlier, []))[1].append(side)
    return found


def _same(one: Corners, other: Corners) -> bool:
    return np.array_equal(one.ids, other.ids) and np.array_equal(one.pixels, other.pixels)


def _common_pose(
    names: Sequence[str], relative: Array, fits: Mask
) -> tuple[Array, Array, dict[int, str]]:
    """The pose right_T_left that the views agree on, and what is wrong with those that do not.

    Only the views that fit their cameras, ``fits``, are asked.
    """
    rotations = Rotation.from_matrix(relative[:, :3, :3])
    asked = np.flatnonzero(fits)
    angles = np.stack([(rotations[asked] * rotations[index].inv()).magnitude() for index in asked])
    # The median rotation: a wrongly paired view may be off by any angle and must not pull the
    # start.
    middle = rotations[int(asked[np.argmin(np.median(angles, axis=1))])]
    off_rad = np.atleast_1d((rotations * middle.inv()).magnitude())
    near = fits & (off_rad <= np.median(off_rad[fits]))
    translation_m = np.median(relative[near, :3, 3], axis=0)
    off_m = np.linalg.norm(relative[:, :3, 3] - translation_m, axis=1)
    baseline_m = float(np.linalg.norm(translation_m))
    bad = (off_rad > _MAX_SPREAD_RAD) | (off_m > _MAX_SPREAD_OF_BASELINE * baseline_m)
    # A few bad views are left out by name. That many mean files that are paired wrongly.
    if (bad | ~fits).mean() > _MAX_BAD:
        worst = ", ".join(np.asarray(names)[bad | ~fits][:8])
        raise PairsInconsistent(f"{(bad | ~fits).sum()} of {len(names)} pairs disagree: {worst}")
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
    doubts = {
        int(index): f"its pictures put the right camera {off_m[index] * 1e3:.0f} mm and "
        f"{np.degrees(off_rad[index]):.1f}° from where the others do"
        for index in np.flatnonzero(bad)
    }
    rotation: Array = middle.as_matrix()
    return rotation, translation_m, doubts


def _same_direction(view: BoardView, board: CalibrationBoard) -> BoardView:
    """Give the right image of a symmetric board the corner order of the left one."""
    left = _row_direction(view.left, board)
    left = left / np.linalg.norm(left)
    orders = [_turned(view.right, board, quarters) for quarters in board.quarter_turns]
    # The cameras of a head look the same way, so the nearest order is the right one.
    right = max(orders, key=lambda one: float(_row_direction(one, board) @ left))
    return replace(view, right=right)


def _turned(corners: Corners, board: CalibrationBoard, quarters: int) -> Corners:
    ids = board.turned_ids(quarters)[corners.ids]
    order = np.argsort(ids)
    return Corners(ids[order], corners.pixels[order])


def _row_direction(corners: Corners, board: CalibrationBoard) -> Array:
    """Mean direction of the board's x axis in the image."""
    column = corners.ids % board.columns
    centred = column - column.mean()
    direction: Array = centred @ (corners.pixels - corners.pixels.mean(axis=0))
    return direction
