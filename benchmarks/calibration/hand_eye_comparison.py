"""``make bench-hand-eye``: the weighted hand-eye solution against closed forms, by truth.

For each kind of error and number of poses all three solve the same sets. The weighted solution
fails where its median or its 95 % error is worse than a closed form's by more than chance.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # Threads only slow the small solves down.

import argparse
import sys
from collections.abc import Callable

import numpy as np
from rich.progress import track
from scipy.spatial.transform import RigidTransform

from benchmarks.calibration.hand_eye_sets import KINDS, PoseErrors, daniilidis, drawn_set, park
from cellctl.calibration.solvers.hand_eye.hand_eye import calibrate_hand_eye
from cellctl.calibration.solvers.hand_eye.hand_eye_result import Setup
from cellctl.geometry.pose import MM, Array, pose_error
from tests.rigs.calibration.hand_eye_views import FLANGE_T_CAMERA, NOISE

COUNTS = (8, 12, 20)
_CHANCE = 0.001
"""Share of comparisons of equals that count as worse."""
_DRAWS = 2000

Statistic = Callable[[Array], Array]


def median(errors: Array) -> Array:
    return np.asarray(np.median(errors, axis=-1))


def worst_but_twentieth(errors: Array) -> Array:
    return np.asarray(np.quantile(errors, 0.95, axis=-1))


def errors_of(kind: PoseErrors, count: int, sets: int) -> tuple[Array, float]:
    """Errors (method, position in mm or angle in degrees, set), and mean NEES / 6 of ours.

    Methods: weighted, Park, Daniilidis.
    """
    found, squared = [], []
    for seed in range(sets):
        poses = drawn_set(kind, count, seed)
        camera = calibrate_hand_eye(poses, Setup.EYE_IN_HAND, noise=NOISE).camera
        error = np.concatenate(pose_error(FLANGE_T_CAMERA, camera.pose))
        squared.append(float(error @ np.linalg.solve(camera.covariance, error)) / 6.0)
        found.append([_sizes(one) for one in (camera.pose, park(poses), daniilidis(poses))])
    return np.array(found).transpose(1, 2, 0), float(np.mean(squared))


def _sizes(found: RigidTransform) -> tuple[float, float]:
    off_m, off_rad = pose_error(FLANGE_T_CAMERA, found)
    return float(np.linalg.norm(off_m)) / MM, float(np.degrees(np.linalg.norm(off_rad)))


def worse(ours: Array, theirs: Array, statistic: Statistic) -> bool:
    """Whether ours is worse by more than chance, by drawing sets of the same ones again."""
    draws = np.random.default_rng(0).integers(0, len(ours), (_DRAWS, len(ours)))
    ratios = statistic(ours[draws]) / statistic(theirs[draws])
    return float(np.quantile(ratios, _CHANCE)) > 1.0


def cell(errors: Array) -> str:
    """Median and 95 %, mm and degrees."""
    (mm, mm_95), (deg, deg_95) = ((median(one), worst_but_twentieth(one)) for one in errors)
    return f"{mm:.3f}, {mm_95:.3f} / {deg:.4f}, {deg_95:.4f}"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-n", type=int, default=60, help="sets of each kind and number of poses")
    parser.add_argument("--kinds", nargs="*", default=list(KINDS), choices=list(KINDS))
    arguments = parser.parse_args()
    rows, bad, ratios = [], [], []
    cases = [(name, count) for name in arguments.kinds for count in COUNTS]
    for name, count in track(cases, "cases", transient=True):
        errors, squared = errors_of(KINDS[name], count, arguments.n)
        rows.append(f"| {name}, {count} | {' | '.join(map(cell, errors))} | {squared:.2f} |")
        for of_closed_form in errors[1:]:
            for ours, theirs in zip(errors[0], of_closed_form, strict=True):
                for statistic in (median, worst_but_twentieth):
                    ratios.append(float(statistic(ours) / statistic(theirs)))
                    if worse(ours, theirs, statistic):
                        bad.append(f"{name}, {count} poses: {ratios[-1]:.2f} times a closed form")
    print("| errors, poses | weighted | Park | Daniilidis | NEES / 6 |\n|---|---|---|---|---|")
    print("\n".join(rows))
    print(f"ratios to closed forms: mean {np.exp(np.mean(np.log(ratios))):.2f}, "
          f"largest {max(ratios):.2f}")  # fmt: skip
    print("\n".join(bad) or "nowhere worse by more than chance")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
