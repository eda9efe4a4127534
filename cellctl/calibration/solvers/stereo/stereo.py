"""Calibration of a stereo head from views of a board (paper section 2.1.1, table 1).

Both cameras, all board poses and the shape of the board are adjusted together. The board's shape
is released because a bow of 0.1 mm does not show in the residuals but costs tenths of a
millimetre (docs/calibration.md has the figures).
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import compress

import numpy as np

from cellctl.calibration.boards.board import BoardView, CalibrationBoard
from cellctl.calibration.boards.board_shape import BoardShape
from cellctl.calibration.boards.known_board import FoundShape, KnownBoard, shape_to_adjust
from cellctl.calibration.boards.lens_model import LensModel
from cellctl.calibration.boards.projection import camera_model
from cellctl.calibration.solvers.bundle import BundleResult, adjust_bundle, residual_norms
from cellctl.calibration.solvers.stereo.bundle import BundleState, StereoProblem
from cellctl.calibration.solvers.stereo.stereo_coverage import check_coverage
from cellctl.calibration.solvers.stereo.stereo_limits import StereoLimits
from cellctl.calibration.solvers.stereo.stereo_result import StereoResult, ViewResidual
from cellctl.calibration.solvers.stereo.stereo_start import start_values
from cellctl.calibration.solvers.stereo.stereo_validation import CrossValidation, cross_validate
from cellctl.calibration.solvers.view_rejection import (
    RobustAdjustment,
    adjust_good_views,
    why_left_out,
)
from cellctl.calibration.solvers.views_of_board import turn_warnings
from cellctl.errors.calibration import TooFewViews
from cellctl.geometry.pose import Array
from cellctl.vision.camera.stereo_head import StereoHead

_MIN_HALF = 5
"""Views that a half calibration needs."""


def calibrate_stereo(
    views: Sequence[BoardView],
    board: CalibrationBoard,
    image_size: tuple[int, int],
    *,
    shape: BoardShape = BoardShape.BENT,
    known: KnownBoard | None = None,
    lens: LensModel = LensModel.FIVE,
    pitch_relative_sigma: float = 0.0,
    limits: StereoLimits | None = None,
) -> StereoResult:
    """Calibrate a head.

    ``known`` is the board as an earlier calibration found it. ``pitch_relative_sigma`` is the
    standard uncertainty of its pitch; nothing in the images can tell it, and it goes into the
    covariance of the translation. Raises ``KnownBoardDiffers``, ``TooFewViews``, ``PoorCoverage``,
    ``CalibrationCamerasSwapped``, ``CalibrationCameraUpsideDown``, ``PairsInconsistent`` or
    ``SolveFailed``; figures beyond their limits are in ``checks``.
    """
    limits = limits or StereoLimits()
    left, right, coverage_checks = check_coverage(views, board, image_size, limits.coverage)
    flat_m, modes = shape_to_adjust(board, shape, known, turns_known=_turns_known(board))
    start = start_values(views, board, image_size, len(modes.sigma), lens)
    problem = StereoProblem(start.views, flat_m, modes, lens)
    adjusted = adjust_good_views(problem, start.state, start.plausible, start.excluded)
    good, result, state = adjusted.good, adjusted.result, adjusted.result.state
    rejected = why_left_out([view.name for view in start.views], adjusted, start.doubts)
    # Judged a second time, because coverage was checked with the views that are now rejected.
    if good.sum() < limits.coverage.views:
        raise TooFewViews(f"{good.sum()} views are left without {'; '.join(rejected)}")
    kept = list(compress(start.views, good))
    board_m = flat_m + modes.modes @ state.shape
    validation = _validate(replace(problem, views=kept), state, board_m)
    head = _head(problem, result, image_size, pitch_relative_sigma)
    return StereoResult(
        head=head,
        method=f"joint bundle adjustment, board shape {shape.value}, lens of {lens.terms} terms",
        board=board,
        views=_view_residuals(start.views, adjusted),
        board_m=board_m,
        found_shape=FoundShape(shape, np.sqrt(np.diag(result.covariance)[problem.head :])),
        coverage=(left, right),
        validation=validation,
        checks=(
            *coverage_checks,
            *limits.checks(
                head,
                np.linalg.norm(state.view_translations_m, axis=1),
                float((~good).mean()),
                None if validation is None else validation.held_out_m,
            ),
        ),
        warnings=(
            *_warnings(len(kept), validation, rejected),
            *([] if _turns_known(board) else turn_warnings(board)),
        ),
        sigma_px=result.sigma_px,
        left_residuals=_field([view.left.pixels for view in kept], result, 0),
        right_residuals=_field([view.right.pixels for view in kept], result, 1),
    )


def _turns_known(board: CalibrationBoard) -> bool:
    """Whether views of a board that looks the same after a turn are named alike."""
    # The search of a chessboard begins at a corner by how the board lies in the image, and a head
    # is hardly turned about its axis from view to view. That of circles begins anywhere.
    return board.circles is None


def _view_residuals(
    views: Sequence[BoardView], adjusted: RobustAdjustment[BundleState]
) -> tuple[ViewResidual, ...]:
    rms_px = [
        tuple(float(np.sqrt((side**2).sum(axis=1).mean())) for side in pair)
        for pair in adjusted.residuals
    ]
    return tuple(
        ViewResidual(
            view.name,
            left,
            right,
            len(view.left.ids),
            len(view.right.ids),
            shift is not None,
            shift,
        )
        for view, (left, right), shift in zip(views, rms_px, adjusted.shift_sigmas, strict=True)
    )


def _validate(problem: StereoProblem, state: BundleState, board_m: Array) -> CrossValidation | None:
    """Two half calibrations, every other view each; None when there are too few views."""
    views = problem.views
    if len(views) < 2 * _MIN_HALF:
        return None
    # Every other view: neighbours in time are alike, so both halves cover the whole range.
    first = np.arange(len(views)) % 2 == 0
    parts = (list(views[0::2]), list(views[1::2]))
    halves = tuple(
        # Each half starts at the full solution: the start saves time and has no influence on the
        # minimum.
        adjust_bundle(problem.of_views(chosen), problem.state_of_views(state, chosen)).state
        for chosen in (first, ~first)
    )
    return cross_validate((halves[0], halves[1]), parts, board_m)


def _head(
    problem: StereoProblem,
    result: BundleResult[BundleState],
    image_size: tuple[int, int],
    pitch_relative_sigma: float,
) -> StereoHead:
    """The head as it was adjusted, with its covariance."""
    state, norms = result.state, np.concatenate(residual_norms(result.residuals))
    return StereoHead(
        image_size=image_size,
        left=camera_model(state.left),
        right=camera_model(state.right),
        rotation=state.rotation,
        translation_m=state.translation_m,
        rms_px=float(np.sqrt((norms**2).mean())),
        covariance=_covariance(result, problem.head, pitch_relative_sigma),
    )


def _covariance(result: BundleResult[BundleState], head: int, pitch_relative_sigma: float) -> Array:
    covariance = result.covariance[:head, :head].copy()
    # A wrong pitch stretches everything that is measured, and with it the baseline.
    scale_m = result.state.translation_m * pitch_relative_sigma
    covariance[-3:, -3:] += np.outer(scale_m, scale_m)
    return covariance


def _warnings(
    kept: int, validation: CrossValidation | None, rejected: Sequence[str]
) -> tuple[str, ...]:
    warnings = [f"left out: {view}" for view in rejected]
    if kept < 20:
        warnings.append(f"{kept} views; 20 to 40 are advisable")
    if validation is None:
        warnings.append(f"no cross-validation: it needs {2 * _MIN_HALF} views")
    return tuple(warnings)


def _field(pixels: Sequence[Array], result: BundleResult[BundleState], side: int) -> Array:
    """Positions and residuals of all corners, shape (n, 4), for the picture."""
    residuals = np.concatenate([pair[side] for pair in result.residuals])
    return np.concatenate([np.concatenate(list(pixels)), residuals], axis=1)
