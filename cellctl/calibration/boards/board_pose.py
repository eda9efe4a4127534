"""Pose of the target board P from its measured discs, weighted, with an outlier test."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from cellctl.errors.calibration import BoardPoseInvalid
from cellctl.geometry.pose import MM, Array
from cellctl.geometry.uncertain import UncertainPose
from cellctl.interfaces.target_tracker import Target
from cellctl.vision.registration.rigid_fit import register

_MIN_DISCS = 4
"""Three discs have a pose, but leave nothing by which a confused one would be noticed."""
_MAX_RMS_M = 2e-3
"""Largest rms distance of the discs from the board. Beyond it discs are confused, or it is another
board."""
_OUTLIER_CHI2 = 25.0
"""Squared normalised residual (3 coordinates) of a disc that does not belong: p below 2e-5."""


@dataclass(frozen=True, slots=True, eq=False)
class BoardPoint:
    """One measured disc."""

    name: str
    position_m: Array
    """Shape (3,), in the frame of the head."""
    covariance_m2: Array
    """Shape (3, 3)."""


@dataclass(frozen=True, slots=True)
class BoardPose:
    """A board in the frame of a head."""

    head_T_board: UncertainPose
    residuals_m: Mapping[str, float]
    """Distance of each used disc from its drawing."""
    outliers: tuple[str, ...]
    chi2_ratio: float
    """Weighted squares over their expectation: 1 when the stated covariances are right."""

    @property
    def rms_m(self) -> float:
        """Rms distance of the discs from their drawing."""
        return float(np.sqrt(np.mean(np.square(list(self.residuals_m.values())))))


def target_board_discs(pitch_x_m: float = 0.1, pitch_y_m: float = 0.08) -> dict[str, Array]:
    """Drawing of board P: P1 to P9 row by row, x along a row, y across, P5 in the middle."""
    return {
        f"P{3 * row + column + 1}": np.array([(column - 1) * pitch_x_m, (row - 1) * pitch_y_m, 0.0])
        for row in range(3)
        for column in range(3)
    }


def points_from_targets(targets: Iterable[Target], names: Iterable[str]) -> list[BoardPoint]:
    """The board's discs among the targets of the large-field head."""
    wanted = set(names)
    return [
        BoardPoint(target.name, target.position_m, np.eye(3) * target.sigma_m**2)
        for target in targets
        if target.name in wanted
    ]


def fit_board(
    drawing: Mapping[str, Array], points: Sequence[BoardPoint], *, disc_sigma_m: float = 5e-6
) -> BoardPose:
    """Pose of the board; ``disc_sigma_m`` is the drawing's own uncertainty per coordinate.

    Raises ``BoardPoseInvalid`` with fewer than four discs, discs on a line, a name that is unknown
    or comes twice, or discs that do not fit the drawing.
    """
    unknown = [point.name for point in points if point.name not in drawing]
    if unknown:
        raise BoardPoseInvalid(f"not on the board: {', '.join(unknown)}")
    counted = Counter(point.name for point in points)
    # A disc that is read twice would pass for two, of which four are needed.
    if twice := [name for name, count in counted.items() if count > 1]:
        raise BoardPoseInvalid(f"measured twice: {', '.join(twice)}")
    used, outliers = list(points), []
    while True:
        pose, residuals, squares, chi2_ratio = _fit(drawing, used, disc_sigma_m)
        worst = int(np.argmax(squares))
        # Against the typical disc: noise that was stated too small must not reject good discs.
        if squares[worst] <= _OUTLIER_CHI2 * max(1.0, _typical(squares)):
            break
        # One at a time, because one bad disc makes good ones look bad until it is gone.
        outliers.append(used.pop(worst).name)
    # With more, the consensus may be the wrong discs.
    if len(outliers) > len(points) // 3:
        raise BoardPoseInvalid(f"discs off their drawing: {', '.join(outliers)}")
    distances = {
        point.name: float(np.linalg.norm(residual))
        for point, residual in zip(used, residuals, strict=True)
    }
    board = BoardPose(pose, distances, tuple(outliers), chi2_ratio)
    if board.rms_m > _MAX_RMS_M:
        raise BoardPoseInvalid(f"the discs are {board.rms_m / MM:.1f} mm rms off their drawing")
    return board


def _fit(
    drawing: Mapping[str, Array], points: Sequence[BoardPoint], disc_sigma_m: float
) -> tuple[UncertainPose, Array, Array, float]:
    """Pose, residuals (n, 3), their normalised squares (n,), and the reduced chi square."""
    if len(points) < _MIN_DISCS:
        names = ", ".join(point.name for point in points) or "none"
        raise BoardPoseInvalid(f"{len(points)} discs, at least {_MIN_DISCS} needed: {names}")
    on_board = np.stack([drawing[point.name] for point in points])
    measured = np.stack([point.position_m for point in points])
    # Discs on a line leave the turn about that line undetermined.
    if np.linalg.svd(on_board - on_board.mean(axis=0), compute_uv=False)[1] < 10 * MM:
        raise BoardPoseInvalid("the discs lie on a line")
    # The drawing is uncertain too: a printed disc is off its place by some micrometres.
    own = np.eye(3) * disc_sigma_m**2
    covariances_m2 = np.stack([point.covariance_m2 + own for point in points])
    fit = register(on_board, measured, covariances_m2)
    left_m = fit.residuals_m
    squares = np.einsum("nk,nkl,nl->n", left_m, np.linalg.inv(covariances_m2), left_m)
    chi2_ratio = float(squares.sum() / (3 * len(points) - 6))
    covariance = fit.gain @ block_diag(*covariances_m2) @ fit.gain.T * max(1.0, chi2_ratio)
    return UncertainPose(fit.pose, covariance), left_m, squares, chi2_ratio


def _typical(squares: Array) -> float:
    """Median of the squares over its expectation for three coordinates."""
    # 2.37 is the median of a chi square with three degrees of freedom.
    return float(np.median(squares)) / 2.37
