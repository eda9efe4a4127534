"""From measured poses to the next motion: eq. 5 to 16 of the paper, and when to stop.

Frames: B base of the main robot, C1 head I, M frame, D deck, F flange. Errors and thresholds have
six components, x, y, z (m) and rx, ry, rz (rad), in the axes of M.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import MM, Array, pose_error
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.deck_to_frame.faults import (
    CorrectionDiverging,
    CorrectionImplausible,
    CorrectionLimitReached,
    NoProgress,
    UncertaintyTooLarge,
)

CorrectionMethod = Literal["default", "paper"]


def target_M_T_D(deck_thickness_m: float, stand_off_m: float) -> RigidTransform:
    """Deck on the frame's axes, its outer face D1 + D2 above the mating face (eq. 5)."""
    return RigidTransform.from_translation([0.0, 0.0, deck_thickness_m + stand_off_m])


def flange_target(
    base_T_c1: RigidTransform,
    c1_T_M: RigidTransform,
    M_T_D: RigidTransform,
    flange_T_deck: RigidTransform,
) -> RigidTransform:
    """``base_T_flange`` that brings the deck to ``M_T_D`` (eq. 7; eq. 12 and 15 alike)."""
    return base_T_c1 * c1_T_M * M_T_D * flange_T_deck.inv()


def assembly_error(target: RigidTransform, measured: RigidTransform) -> Array:
    """Target minus measured, shape (6,) (eq. 10, 13): x, y, z in m and rx, ry, rz in rad."""
    translation_m, rotation_rad = pose_error(measured, target)
    return np.concatenate([translation_m, rotation_rad])


def next_target(
    commanded: RigidTransform,
    target: RigidTransform,
    measured: RigidTransform,
    method: CorrectionMethod = "default",
) -> RigidTransform:
    """``M_T_D`` to command next (eq. 11, 14), from the one commanded last.

    Default: the pose that maps the measured deck onto the target, applied to the last command,
    ``(target · measured⁻¹) · commanded``. Paper: components of the error in X, Y, Z, A, B, C are
    added to the last command's, R(k) = Δ(k) + R(k-1).
    """
    # From the left: the correction is in the axes of the frame, in which it was measured.
    if method == "default":
        return target * measured.inv() * commanded
    return _add_components(commanded, target, measured)


def _add_components(
    commanded: RigidTransform, target: RigidTransform, measured: RigidTransform
) -> RigidTransform:
    angles = [pose.rotation.as_euler("ZYX") for pose in (commanded, target, measured)]
    translation_m = commanded.translation + target.translation - measured.translation
    rotation = Rotation.from_euler("ZYX", angles[0] + angles[1] - angles[2])
    return RigidTransform.from_components(translation_m, rotation)


@dataclass(frozen=True, slots=True)
class Thresholds:
    """When the deck counts as aligned (eq. 16)."""

    translation_m: float = 0.05 * MM
    """Largest error of each coordinate."""
    rotation_rad: tuple[float, float, float] = (float(np.radians(0.005)),) * 3
    """About x, y and z of the frame."""
    uncertainty_share: float = 0.5
    """Largest standard deviation of a component, in parts of its threshold. However many images are
    taken, six holes of a deck of one metre leave 0.0022° of a usual threshold of 0.005°."""

    @property
    def vector(self) -> Array:
        """Shape (6,)."""
        return np.array([*(self.translation_m,) * 3, *self.rotation_rad])


@dataclass(frozen=True, slots=True, eq=False)
class Judgement:
    """What one measurement at the stand-off says."""

    error: Array
    """Shape (6,): target minus measured."""
    sigma: Array
    """Shape (6,): standard deviations of the measurement."""
    within: bool
    """Every component is within its threshold (eq. 16)."""
    certain: bool
    """Every standard deviation is small against its threshold."""

    @property
    def converged(self) -> bool:
        """The error is within its thresholds, and the measurement is certain enough to say so."""
        return self.within and self.certain


def judge_pose(
    target: RigidTransform, measured: UncertainPose, thresholds: Thresholds
) -> Judgement:
    """Compare a measurement with its target and thresholds (eq. 10 and 16)."""
    error = assembly_error(target, measured.pose)
    limits = thresholds.vector
    return Judgement(
        error,
        measured.sigma,
        bool((np.abs(error) <= limits).all()),
        bool((measured.sigma <= thresholds.uncertainty_share * limits).all()),
    )


def check_uncertainty(judgement: Judgement, thresholds: Thresholds, frames: int) -> None:
    """Raise ``UncertaintyTooLarge`` when the frames taken did not suffice."""
    if judgement.certain:
        return
    allowed = thresholds.uncertainty_share * thresholds.vector
    worst = int(np.argmax(judgement.sigma / allowed))
    raise UncertaintyTooLarge(
        f"standard deviation of {_component(worst, judgement.sigma[worst])} after {frames} frames, "
        f"allowed {_amount(worst, allowed[worst])}"
    )


@dataclass(frozen=True, slots=True)
class CorrectionLimits:
    """Bounds of the loop that corrects the pose."""

    max_corrections: int = 8
    translation_m: float = 10.0 * MM
    """Largest single correction."""
    rotation_rad: float = float(np.radians(1.5))
    progress_ratio: float = 0.9
    """Two corrections together must bring the error below this share of what it was."""
    growth_ratio: float = 1.5
    """One correction must not bring the error above this multiple of what it was."""


def check_correction(error: Array, limits: CorrectionLimits) -> None:
    """Raise ``CorrectionImplausible`` when one correction is larger than can be needed."""
    sizes = np.array([np.linalg.norm(error[:3]), np.linalg.norm(error[3:])])
    allowed = np.array([limits.translation_m, limits.rotation_rad])
    # A correction that is not a number would pass every comparison that asks whether it is too
    # great.
    if not np.isfinite(sizes).all() or (sizes > allowed).any():
        raise CorrectionImplausible(
            f"{sizes[0] / MM:.3f} mm, {np.degrees(sizes[1]):.4f}°; allowed "
            f"{allowed[0] / MM:.3f} mm, {np.degrees(allowed[1]):.4f}°"
        )


def check_progress(
    history: Sequence[Judgement], thresholds: Thresholds, limits: CorrectionLimits
) -> None:
    """Raise when another correction makes no sense; ``history`` has one entry a measurement.

    ``CorrectionDiverging`` when the last correction made things worse beyond what noise explains,
    ``NoProgress`` when two corrections brought nothing, ``CorrectionLimitReached`` when there were
    too many. Nothing is raised once the last measurement converged.
    """
    # Success comes before every bound: a last allowed correction that converged is no failure.
    if not history or history[-1].converged:
        return
    sizes = [_size(item, thresholds) for item in history]
    # In parts of the threshold, like the sizes it is added to. Without it a loop at the level of
    # its noise would count as diverging.
    noise = 3.0 * float((history[-1].sigma / thresholds.vector).max())
    # Within the threshold (1.0) growth is of no interest: there only the uncertainty keeps the loop
    # from ending.
    if len(sizes) >= 2 and sizes[-1] > limits.growth_ratio * sizes[-2] + noise and sizes[-1] > 1.0:
        raise CorrectionDiverging(_history_text(history))
    if len(sizes) >= 3 and sizes[-1] > limits.progress_ratio * sizes[-3] + noise:
        raise NoProgress(_history_text(history))
    if len(history) > limits.max_corrections:
        raise CorrectionLimitReached(f"{limits.max_corrections} corrections")


def _size(judgement: Judgement, thresholds: Thresholds) -> float:
    """Worst component in parts of its threshold."""
    return float((np.abs(judgement.error) / thresholds.vector).max())


def _history_text(history: Sequence[Judgement]) -> str:
    errors = (
        f"{np.linalg.norm(item.error[:3]) / MM:.3f} mm "
        f"{np.degrees(np.linalg.norm(item.error[3:])):.4f}°"
        for item in history
    )
    return "error by measurement: " + ", ".join(errors)


def _component(index: int, value: float) -> str:
    return f"{('x', 'y', 'z', 'rx', 'ry', 'rz')[index]} is {_amount(index, value)}"


def _amount(index: int, value: float) -> str:
    return f"{value / MM:.4f} mm" if index < 3 else f"{np.degrees(value):.5f}°"
