"""Calibration of one camera from views of a board.

The camera, all board poses and the shape of the board are adjusted together. The shape is released
for the same reason as with a stereo head: a board of 17 mm that is bent by 4 µm moves the focal
length of a 25 mm lens by half a percent and does not show in the residuals.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import compress

import numpy as np
from numpy.typing import NDArray

from cellctl.calibration.boards.board import CalibrationBoard, CameraView
from cellctl.calibration.boards.board_in_camera import board_in_camera
from cellctl.calibration.boards.board_shape import BoardShape
from cellctl.calibration.boards.known_board import FoundShape, KnownBoard, shape_to_adjust
from cellctl.calibration.boards.lens_model import LensModel
from cellctl.calibration.boards.projection import camera_model
from cellctl.calibration.checks import LimitCheck
from cellctl.calibration.solvers.bundle import BundleResult, adjust_bundle, residual_norms
from cellctl.calibration.solvers.camera_start import CameraStart, start_of_camera
from cellctl.calibration.solvers.coverage import Coverage, CoverageLimits, coverage
from cellctl.calibration.solvers.single_camera.single_camera_bundle import (
    CameraBundle,
    CameraProblem,
)
from cellctl.calibration.solvers.single_camera.single_camera_result import (
    CameraViewResidual,
    SingleCameraResult,
)
from cellctl.calibration.solvers.single_camera.two_cameras import MOST_PAIRED, share_of_pairs
from cellctl.calibration.solvers.view_rejection import (
    MAX_REJECTED_RATIO,
    RobustAdjustment,
    adjust_good_views,
    repeated,
    why_left_out,
)
from cellctl.calibration.solvers.views_of_board import turn_warnings
from cellctl.errors.calibration import PoorCoverage, TooFewViews
from cellctl.vision.camera.single_camera import SingleCamera

_MIN_HALF = 8
"""Views that a half calibration needs."""


@dataclass(frozen=True, slots=True)
class SingleCameraLimits:
    """Limits of the result. Pixel figures count both axes of a corner, as OpenCV does."""

    coverage: CoverageLimits = field(
        # A long lens sees a small board: tilted by 20° its far side is hardly smaller than its near
        # one. Whether that was enough shows in the sigma of the focal length.
        default_factory=lambda: CoverageLimits(tilt_ratio=0.003)
    )
    rms_px: float = 0.25
    held_out_px: float = 0.3
    focal_sigma_ratio: float = 2e-3
    """Largest standard deviation of the focal length over it. Focal length and distance go
    together: what stays of an error within the depth of the views is smaller by the ratio of that
    depth to the distance."""
    rejected_ratio: float = MAX_REJECTED_RATIO

    def checks(
        self,
        rms_px: float,
        focal_ratio: float,
        rejected_ratio: float,
        paired: float,
        held_out_px: float | None,
    ) -> list[LimitCheck]:
        """The figures of a result against these limits; ``held_out_px`` is None without halves."""
        checks = [
            LimitCheck("reprojection rms", rms_px, self.rms_px, "px"),
            LimitCheck("focal length sigma", focal_ratio, self.focal_sigma_ratio, ""),
            LimitCheck("rejected views", rejected_ratio, self.rejected_ratio, ""),
            LimitCheck("views in pairs, as of the two cameras of a head", paired, MOST_PAIRED, ""),
        ]
        if held_out_px is not None:
            checks.append(LimitCheck("held-out rms", held_out_px, self.held_out_px, "px"))
        return checks


def calibrate_single_camera(
    views: Sequence[CameraView],
    board: CalibrationBoard,
    image_size: tuple[int, int],
    *,
    shape: BoardShape = BoardShape.BENT,
    known: KnownBoard | None = None,
    lens: LensModel = LensModel.FIVE,
    limits: SingleCameraLimits | None = None,
) -> SingleCameraResult:
    """Calibrate a camera; ``image_size`` is width, height in px.

    ``known`` is the board as an earlier calibration found it. Raises ``KnownBoardDiffers``,
    ``TooFewViews``, ``PoorCoverage`` or ``SolveFailed``; figures beyond their limits are in
    ``checks``.
    """
    limits = limits or SingleCameraLimits()
    covered, coverage_checks = _covered(views, board, image_size, limits.coverage)
    flat_m, modes = shape_to_adjust(board, shape, known)
    start = start_of_camera([view.corners for view in views], board, image_size)
    seen = [
        CameraView(view.name, corners) for view, corners in zip(views, start.images, strict=True)
    ]
    problem = CameraProblem(seen, flat_m, modes, lens)
    again = repeated([view.corners for view in views])
    excluded = np.array([index in again for index in range(len(views))])
    adjusted = adjust_good_views(
        problem, _start(start, len(modes.sigma), lens), start.fits, excluded
    )
    paired = share_of_pairs(np.stack(start.camera_T_board))
    good, result, state = adjusted.good, adjusted.result, adjusted.result.state
    twice = {i: f"its picture is that of {views[earlier].name}" for i, earlier in again.items()}
    rejected = why_left_out([view.name for view in views], adjusted, twice)
    # Judged a second time, because coverage was checked with the views that are now rejected.
    if good.sum() < limits.coverage.views:
        raise TooFewViews(f"{good.sum()} views are left without {'; '.join(rejected)}")
    kept = list(compress(seen, good))
    norms = np.concatenate(residual_norms(result.residuals))
    rms_px = float(np.sqrt((norms**2).mean()))
    held_out_px = _held_out_px(replace(problem, views=kept), state)
    sigma = np.sqrt(np.diag(result.covariance)[: len(state.camera)])
    focal_ratio = float((sigma[:2] / state.camera[:2]).max())
    return SingleCameraResult(
        camera=SingleCamera(image_size, camera_model(state.camera)),
        method=f"joint bundle adjustment, board shape {shape.value}, lens of {lens.terms} terms",
        board=board,
        views=_view_residuals(views, adjusted),
        board_m=flat_m + modes.modes @ state.shape,
        found_shape=FoundShape(shape, np.sqrt(np.diag(result.covariance)[len(state.camera) :])),
        coverage=covered,
        sigma=sigma,
        rms_px=rms_px,
        held_out_px=held_out_px,
        sigma_px=result.sigma_px,
        checks=(
            *coverage_checks,
            *limits.checks(rms_px, focal_ratio, float((~good).mean()), paired, held_out_px),
        ),
        warnings=(*_warnings(len(kept), rejected, held_out_px), *turn_warnings(board)),
        residuals=_field(kept, result),
    )


def _covered(
    views: Sequence[CameraView],
    board: CalibrationBoard,
    image_size: tuple[int, int],
    limits: CoverageLimits,
) -> tuple[Coverage, tuple[LimitCheck, ...]]:
    if len(views) < limits.views:
        names = ", ".join(view.name for view in views) or "none"
        raise TooFewViews(f"{len(views)} usable views, at least {limits.views} needed: {names}")
    covered = coverage([view.corners for view in views], board, image_size)
    checks = (
        LimitCheck("views", len(views), limits.views, "", "min"),
        LimitCheck(
            "image cells with corners", covered.filled_ratio, limits.filled_ratio, "", "min"
        ),
        LimitCheck("tilt of the board", covered.tilt_ratio, limits.tilt_ratio, "", "min"),
    )
    # Refused before solving: a solution from such views exists, has small residuals, and is wrong.
    failed = [str(check) for check in checks if not check.passed]
    if failed:
        raise PoorCoverage("; ".join(failed))
    return covered, checks


def _start(start: CameraStart, modes: int, lens: LensModel) -> CameraBundle:
    return CameraBundle(
        camera=start.with_terms(lens.terms),
        shape=np.zeros(modes),
        view_rotations=np.stack([pose[:3, :3] for pose in start.camera_T_board]),
        view_translations_m=np.stack([pose[:3, 3] for pose in start.camera_T_board]),
    )


def _view_residuals(
    views: Sequence[CameraView], adjusted: RobustAdjustment[CameraBundle]
) -> tuple[CameraViewResidual, ...]:
    return tuple(
        CameraViewResidual(
            view.name, float(rms_px), len(view.corners.ids), shift is not None, shift
        )
        for view, rms_px, shift in zip(
            views, adjusted.view_rms_px, adjusted.shift_sigmas, strict=True
        )
    )


def _held_out_px(problem: CameraProblem, state: CameraBundle) -> float | None:
    """Residual of each half of the views in a camera that was calibrated with the other half."""
    views, modes = problem.views, problem.modes
    if len(views) < 2 * _MIN_HALF:
        return None
    # Every other view: neighbours in time are alike, so both halves cover the whole range.
    first = np.arange(len(views)) % 2 == 0
    squares, count = 0.0, 0
    for own in (first, ~first):
        half = adjust_bundle(problem.of_views(own), problem.state_of_views(state, own)).state
        camera, board_m = camera_model(half.camera), problem.flat_m + modes.modes @ half.shape
        for view, is_own in zip(views, own, strict=True):
            if is_own:
                continue
            corners = view.corners
            _, rms_px = board_in_camera(camera, board_m[corners.ids], corners.pixels)
            squares += rms_px**2 * len(corners.ids)
            count += len(corners.ids)
    return float(np.sqrt(squares / count))


def _warnings(kept: int, rejected: Sequence[str], held_out_px: float | None) -> tuple[str, ...]:
    warnings = [f"left out: {view}" for view in rejected]
    if kept < 20:
        warnings.append(f"{kept} views; 20 to 40 are advisable")
    if held_out_px is None:
        warnings.append(f"no cross-validation: it needs {2 * _MIN_HALF} views")
    return tuple(warnings)


def _field(views: Sequence[CameraView], result: BundleResult[CameraBundle]) -> NDArray[np.float64]:
    """Positions and residuals of all corners, shape (n, 4), for the picture."""
    pixels = np.concatenate([view.corners.pixels for view in views])
    residuals = np.concatenate([images[0] for images in result.residuals])
    return np.concatenate([pixels, residuals], axis=1)
