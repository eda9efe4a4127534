"""Views that do not fit the others are left out by name, and the rest is solved.

Files are mixed up, a board is moved between two exposures, a picture is stored twice. Such a view
must not decide over a calibration. Those that show themselves in the start values never enter the
adjustment; after it, every view is judged by the same rule: the residuals of its corners at the
best pose that its board can have.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from cellctl.calibration.boards.board import Corners
from cellctl.calibration.solvers.bundle import (
    ROUGH,
    BundleProblem,
    BundleResult,
    adjust_bundle,
    place_board,
    residual_norms,
    residuals_of,
)
from cellctl.geometry.pose import Array

Mask = NDArray[np.bool_]

_BAD_VIEW = 2.5
"""A view is bad when its rms is so many times the median view's."""
MAX_REJECTED_RATIO = 0.2
"""Largest share of bad views. More mean that something is wrong with all of them."""

S = TypeVar("S")


class ProblemOfViews(BundleProblem[S], Protocol[S]):
    """An adjustment of which any views can be chosen."""

    def __len__(self) -> int:
        """Number of views."""

    def of_views(self, chosen: Mask) -> Self:
        """The adjustment of the chosen views alone."""

    def state_of_views(self, state: S, chosen: Mask) -> S:
        """The unknowns of the chosen views alone."""

    def joined(self, shared: S, views: S) -> S:
        """What the views share from one, the poses of the boards from the other."""


@dataclass(frozen=True, slots=True, eq=False)
class RobustAdjustment(Generic[S]):
    """The adjustment of the good views, and how all views fit it."""

    result: BundleResult[S]
    """The adjustment of the good views alone."""
    good: Mask
    """Shape (views,)."""
    residuals: tuple[tuple[Array, ...], ...]
    """Residuals of all views, each with its board at the best pose, px."""

    @property
    def view_rms_px(self) -> Array:
        """Root mean square of the residuals of each view, both axes together, shape (views,)."""
        return _view_rms(self.residuals)

    @property
    def shift_sigmas(self) -> list[float | None]:
        """How much the solution moves without each view; None for those that were left out."""
        shifts = iter(self.result.shift_sigmas)
        return [float(next(shifts)) if used else None for used in self.good]


def adjust_good_views(
    problem: ProblemOfViews[S], start: S, plausible: Mask, excluded: Mask
) -> RobustAdjustment[S]:
    """Adjust with the views that fit each other.

    ``plausible``, shape (views,), are those whose start values agree. The others are judged when
    these have been adjusted, and come back if they fit; those ``excluded`` never do. Raises
    ``SolveFailed``.
    """
    used = plausible & ~excluded
    state = problem.state_of_views(start, used)
    result = adjust_bundle(problem.of_views(used), state, ROUGH)
    # Bad views have pulled the solution, and good ones were missing. The second choice may still
    # bring a view to the other side of the limit, and then it stands.
    for _ in range(2):
        residuals = _all_residuals(problem, result, start)
        good = good_views(_view_rms(residuals), used) & ~excluded
        if (good == used).all():
            break
        state = problem.state_of_views(problem.joined(result.state, start), good)
        result, used = adjust_bundle(problem.of_views(good), state, ROUGH), good
    result = adjust_bundle(problem.of_views(used), result.state)
    return RobustAdjustment(result, used, _all_residuals(problem, result, start))


def why_left_out(
    names: Sequence[str], adjusted: RobustAdjustment[S], doubts: Mapping[int, str]
) -> list[str]:
    """``NAME: reason`` of each view that was left out."""
    rms_px, good = adjusted.view_rms_px, adjusted.good
    typical_px = float(np.median(rms_px[good]))
    misfits = [
        f"its corners are off by {one:.2f} px, those of the others by {typical_px:.2f} px"
        for one in rms_px
    ]
    return [
        f"{name}: {doubts.get(index, misfits[index])}"
        for index, (name, used) in enumerate(zip(names, good, strict=True))
        if not used
    ]


def good_views(view_rms: Array, judges: Mask) -> Mask:
    """Which views are good, from the rms residual of each, shape (views,).

    ``judges`` are the views whose median is the measure of all.
    """
    return np.asarray(view_rms <= _BAD_VIEW * np.median(view_rms[judges]), dtype=np.bool_)


def repeated(images: Sequence[Corners]) -> dict[int, int]:
    """Images whose corners are those of an earlier one to the last digit: index to earlier index.

    Two exposures of one board never agree to the last digit, since no two have the same noise.
    """
    first: dict[bytes, int] = {}
    again = {}
    for index, corners in enumerate(images):
        key = corners.ids.tobytes() + corners.pixels.tobytes()
        if key in first:
            again[index] = first[key]
        else:
            first[key] = index
    return again


def _all_residuals(
    problem: ProblemOfViews[S], result: BundleResult[S], start: S
) -> tuple[tuple[Array, ...], ...]:
    state = problem.joined(result.state, start)
    residuals: list[tuple[Array, ...]] = []
    # One view at a time: a board that finds no place must not keep the others from theirs.
    for view in np.eye(len(problem), dtype=np.bool_):
        alone = problem.of_views(view)
        placed = place_board(alone, problem.state_of_views(state, view), result.sigma_px)
        residuals += residuals_of(alone, placed)
    return tuple(residuals)


def _view_rms(residuals: Sequence[tuple[Array, ...]]) -> Array:
    return np.array([np.sqrt((norms**2).mean()) for norms in residual_norms(residuals)])
