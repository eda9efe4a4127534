"""Coverage of the views of a stereo calibration, judged before anything is solved."""

from collections.abc import Sequence

from cellctl.calibration.boards.board import BoardView, CalibrationBoard
from cellctl.calibration.checks import LimitCheck
from cellctl.calibration.solvers.coverage import Coverage, CoverageLimits, coverage
from cellctl.errors.calibration import PoorCoverage, TooFewViews


def check_coverage(
    views: Sequence[BoardView],
    board: CalibrationBoard,
    image_size: tuple[int, int],
    limits: CoverageLimits,
) -> tuple[Coverage, Coverage, tuple[LimitCheck, ...]]:
    """Coverage of both cameras and the checks; ``TooFewViews`` or ``PoorCoverage`` if refused."""
    if len(views) < limits.views:
        names = ", ".join(view.name for view in views) or "none"
        raise TooFewViews(f"{len(views)} usable views, at least {limits.views} needed: {names}")
    left = coverage([view.left for view in views], board, image_size)
    right = coverage([view.right for view in views], board, image_size)
    checks = (
        LimitCheck("views", len(views), limits.views, "", "min"),
        _worst("image cells with corners", "filled_ratio", left, right, limits.filled_ratio),
        _worst("tilt of the board", "tilt_ratio", left, right, limits.tilt_ratio),
    )
    # Refused before solving: a solution from such views exists, has small residuals, and is wrong.
    failed = [str(check) for check in checks if not check.passed]
    if failed:
        raise PoorCoverage("; ".join(failed))
    return left, right, checks


def _worst(name: str, field: str, left: Coverage, right: Coverage, limit: float) -> LimitCheck:
    value = min(float(getattr(left, field)), float(getattr(right, field)))
    return LimitCheck(name, value, limit, "", "min")
