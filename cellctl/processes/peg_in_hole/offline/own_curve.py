"""Whether a curve is that of the run whose record says what was inserted."""

from collections.abc import Mapping
from math import isfinite
from typing import Any, TypeGuard

from cellctl.geometry.pose import MM
from cellctl.processes.peg_in_hole.faults import PegCurveInvalid
from cellctl.processes.peg_in_hole.verdict.evidence import InsertionEvidence

_FORCE_SHARE, _FORCE_N, _DEPTH_MM = 0.2, 1.0, 0.1
"""Another curve, or one in another unit, differs by more. The same one, judged by other rules than
those of its day, does not: both figures are read off its end."""


def require_own_curve(found: InsertionEvidence, recorded: Mapping[str, Any] | None) -> None:
    """Compare with the evidence that the run recorded; None when it came to no verdict.

    Raises ``PegCurveInvalid``: a curve judged by the task of another run may look inserted.
    """
    if recorded is None:
        return
    force_n, depth_m = recorded.get("seat_force_n"), recorded.get("depth_m")
    if _is_known(force_n):
        allowed_n = max(_FORCE_N, _FORCE_SHARE * abs(force_n))
        _require_near("seat force", found.seat_force_n, force_n, allowed_n, "N")
    if _is_known(depth_m) and found.depth_m is not None:
        _require_near("depth of the seat", found.depth_m / MM, depth_m / MM, _DEPTH_MM, "mm")


def _is_known(figure: object) -> TypeGuard[float]:
    return isinstance(figure, float | int) and isfinite(figure)


def _require_near(words: str, here: float | None, there: float, allowed: float, unit: str) -> None:
    if here is not None and abs(here - there) > allowed:
        raise PegCurveInvalid(
            f"its {words} is {here:.4g} {unit}, that of the run in the task {there:.4g} {unit}: it "
            "is the curve of another run, or in other units"
        )
