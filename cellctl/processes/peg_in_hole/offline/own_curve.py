"""Whether a curve is that of the run whose record says what was inserted."""

from collections.abc import Mapping
from math import isfinite
from typing import Any

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
    for name, unit, scale, allowed in (
        ("seat_force_n", "N", 1.0, _FORCE_N),
        ("depth_m", "mm", MM, _DEPTH_MM),
    ):
        here, there = getattr(found, name), recorded.get(name)
        if here is None or not isinstance(there, float | int) or not isfinite(there):
            continue
        share = _FORCE_SHARE * abs(there) / scale if unit == "N" else 0.0
        if abs(here - there) / scale > max(allowed, share):
            words = "seat force" if unit == "N" else "depth of the seat"
            raise PegCurveInvalid(
                f"its {words} is {here / scale:.4g} {unit}, that of the run in the task "
                f"{there / scale:.4g} {unit}: it is the curve of another run, or in other units"
            )
