"""Both small-field heads in the base, by way of the target board (section 2.1.2, fig. 3).

The printed equation 3 has its indices garbled: it gives B_T_C2^-1 · B_T_C1, the pose of C1 in C2.
Table 2 of the paper confirms the form used here.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cellctl.calibration.boards.board_pose import BoardPose
from cellctl.calibration.checks import (
    Checks,
    LimitCheck,
    all_passed,
    checks_from_record,
    evidence_to_record,
)
from cellctl.calibration.pose_record import pose_from_record, pose_to_record
from cellctl.calibration.solvers.pose_average import average
from cellctl.errors.calibration import BoardPoseInvalid
from cellctl.geometry.pose import MM
from cellctl.geometry.uncertain import UncertainPose


@dataclass(frozen=True, slots=True)
class BoardPlacement:
    """One place of the board, measured by the large-field head and by a small-field head."""

    c_T_board: BoardPose
    head_T_board: BoardPose


@dataclass(frozen=True, slots=True)
class TransferLimits:
    """Limits of the result."""

    large_field_rms_m: float = 2e-4
    head_rms_m: float = 3e-5
    position_sigma_m: float = 2e-4
    rotation_sigma_rad: float = float(np.radians(0.01))
    agreement: float = 4.0
    """Reduced chi square between several placements."""


@dataclass(frozen=True, slots=True)
class TransferResult:
    """Both heads, for the measuring poses of the auxiliary robots only."""

    base_T_c1: UncertainPose
    base_T_c2: UncertainPose
    c1_T_c2: UncertainPose
    residuals_m: Mapping[str, float]
    """Per disc: ``head 1, placement 1, C P3`` is P3 seen by the large-field head."""
    checks: Checks
    warnings: tuple[str, ...]
    method: str = "target board, weighted registration, equations 1 to 3"

    @property
    def passed(self) -> bool:
        """The verdict."""
        return all_passed(self.checks)

    def to_record(self) -> dict[str, Any]:
        """Plain data for the store."""
        return {
            **evidence_to_record(self.method, self.checks, self.warnings),
            "base_T_c1": pose_to_record(self.base_T_c1),
            "base_T_c2": pose_to_record(self.base_T_c2),
            "c1_T_c2": pose_to_record(self.c1_T_c2),
            "residuals_mm": {name: value / MM for name, value in self.residuals_m.items()},
        }

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> "TransferResult":
        """The inverse of ``to_record``."""
        return cls(
            base_T_c1=pose_from_record(record["base_T_c1"]),
            base_T_c2=pose_from_record(record["base_T_c2"]),
            c1_T_c2=pose_from_record(record["c1_T_c2"]),
            residuals_m={name: value * MM for name, value in record["residuals_mm"].items()},
            checks=checks_from_record(record["checks"]),
            warnings=tuple(record["warnings"]),
            method=str(record["method"]),
        )


def head_2_in_head_1(base_T_c1: UncertainPose, base_T_c2: UncertainPose) -> UncertainPose:
    """Equation 3: C1_T_C2 = (B_T_C1)^-1 · B_T_C2.

    The covariance holds for independent poses. Both contain the same C_T_B, which cancels; use
    ``calibrate_board_transfer`` for a covariance that knows this.
    """
    return base_T_c1.inv() * base_T_c2


def calibrate_board_transfer(
    c_T_base: UncertainPose,
    before_head_1: Sequence[BoardPlacement],
    before_head_2: Sequence[BoardPlacement],
    *,
    limits: TransferLimits | None = None,
) -> TransferResult:
    """Equations 1 to 3 with covariances, over one or more placements before each head.

    Raises ``BoardPoseInvalid`` when a head has no placement.
    """
    limits = limits or TransferLimits()
    for name, placements in (("I", before_head_1), ("II", before_head_2)):
        if not placements:
            raise BoardPoseInvalid(f"no placement of the board before head {name}")
    c_T_c1, agreement_1 = _head_in_large_field(before_head_1)
    c_T_c2, agreement_2 = _head_in_large_field(before_head_2)
    # Equations 1 and 2: B_T_Ci = (C_T_B)^-1 · C_T_P · (Ci_T_P)^-1. The board is the link: both
    # heads measure it in the same place, and it drops out of the product.
    base_T_c1 = c_T_base.inv() * c_T_c1
    base_T_c2 = c_T_base.inv() * c_T_c2
    # The pose by equation 3; the covariance without C_T_B, which is in both factors.
    c1_T_c2 = UncertainPose(
        head_2_in_head_1(base_T_c1, base_T_c2).pose, (c_T_c1.inv() * c_T_c2).covariance
    )
    both = (*before_head_1, *before_head_2)
    large_mm = max(placement.c_T_board.rms_m for placement in both) / MM
    small_mm = max(placement.head_T_board.rms_m for placement in both) / MM
    sigma = c1_T_c2.sigma
    position_mm, position_limit_mm = sigma[:3].max() / MM, limits.position_sigma_m / MM
    rotation_limit_deg = float(np.degrees(limits.rotation_sigma_rad))
    checks = (
        LimitCheck("board rms, large-field head", large_mm, limits.large_field_rms_m / MM, "mm"),
        LimitCheck("board rms, small-field heads", small_mm, limits.head_rms_m / MM, "mm"),
        LimitCheck("C1_T_C2 position sigma", position_mm, position_limit_mm, "mm"),
        LimitCheck("C1_T_C2 rotation sigma", np.degrees(sigma[3:].max()), rotation_limit_deg, "°"),
        # Several placements are the only witness of what one placement cannot show: a board that
        # moved between the two heads' exposures.
        LimitCheck("agreement of placements", max(agreement_1, agreement_2), limits.agreement, ""),
    )
    return TransferResult(
        base_T_c1=base_T_c1,
        base_T_c2=base_T_c2,
        c1_T_c2=c1_T_c2,
        residuals_m={**_residuals(1, before_head_1), **_residuals(2, before_head_2)},
        checks=checks,
        warnings=(*_warnings(1, before_head_1), *_warnings(2, before_head_2)),
    )


def _head_in_large_field(placements: Sequence[BoardPlacement]) -> tuple[UncertainPose, float]:
    """C_T_Ci as the mean over the placements, and how well they agree."""
    return average(
        [one.c_T_board.head_T_board * one.head_T_board.head_T_board.inv() for one in placements]
    )


def _residuals(head: int, placements: Sequence[BoardPlacement]) -> dict[str, float]:
    return {
        f"head {head}, placement {number}, {side} {name}": value
        for number, placement in enumerate(placements, start=1)
        for side, board in (("C", placement.c_T_board), (f"C{head}", placement.head_T_board))
        for name, value in board.residuals_m.items()
    }


def _warnings(head: int, placements: Sequence[BoardPlacement]) -> tuple[str, ...]:
    return tuple(
        f"head {head}, placement {number}: {side} left out {', '.join(board.outliers)}"
        for number, placement in enumerate(placements, start=1)
        for side, board in (("C", placement.c_T_board), (f"C{head}", placement.head_T_board))
        if board.outliers
    )
