"""Accuracy of the calibrations over many seeds, at corner and point level: the tables of
docs/calibration.md. About three minutes on one core.

    python -m benchmarks.calibration.accuracy [stereo|images|base-frame|hand-eye]
"""

import sys
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from benchmarks.calibration.cases import (
    base_frame_errors,
    base_frame_nees,
    hand_eye_errors,
    image_calibration,
    stereo_case,
)
from cellctl.calibration.boards.board_shape import BoardShape

Array = NDArray[np.float64]


def stereo() -> None:
    """Board bow against what the adjustment may learn about the board."""
    print("| bow mm | board in the adjustment | rms px | absolute µm | without offset µm |", end="")
    print(" held out µm | NEES / 24 |\n|---|---|---|---|---|---|---|")
    for sag_mm in (0.0, 0.05, 0.1):
        for shape in BoardShape:
            cases = [stereo_case(seed, sag_mm * 1e-3, shape) for seed in range(24)]
            absolute, relative = (
                np.sqrt(np.mean([case.errors_m[i] ** 2 for case in cases])) * 1e6 for i in (0, 1)
            )
            rms_px = np.mean([case.rms_px for case in cases])
            held_out = np.mean([case.held_out_m for case in cases]) * 1e6
            nees = np.mean([case.nees for case in cases]) / 24
            print(
                f"| {sag_mm} | {shape.value} | {rms_px:.4f} | {absolute:.0f} | {relative:.1f} "
                f"| {held_out:.1f} | {nees:.2f} |"
            )


def hanging_together() -> None:
    """Errors that are smooth within a view: is the covariance still honest?"""
    print("| views | error of a term px | absolute µm | NEES / 24 |\n|---|---|---|---|")
    for views in (16, 30, 50):
        for hanging_px in (0.0, 0.05):
            cases = [
                stereo_case(seed, 0.0, BoardShape.BENT, views=views, hanging_px=hanging_px)
                for seed in range(24)
            ]
            absolute = np.sqrt(np.mean([case.errors_m[0] ** 2 for case in cases])) * 1e6
            nees = np.mean([case.nees for case in cases]) / 24
            print(f"| {views} | {hanging_px} | {absolute:.0f} | {nees:.2f} |")


def images() -> None:
    """Calibrate a head from rendered images, once for each seed."""
    print("| seed | views | rms px | absolute µm | without offset µm | board flat to µm (truth) |")
    print("|---|---|---|---|---|---|")
    for seed in range(3):
        case = image_calibration(seed)
        print(
            f"| {seed} | {case.views} | {case.rms_px:.4f} | {case.errors_m[0] * 1e6:.0f} "
            f"| {case.errors_m[1] * 1e6:.1f} | {case.flatness_m * 1e6:.0f} "
            f"({case.true_flatness_m * 1e6:.0f}) |"
        )


def base_frame() -> None:
    """Arc, stops and targets."""
    print("| arc, stops, targets | position mm (worst axis) | rotation ° (worst axis) | NEES / 6 |")
    print("|---|---|---|---|")
    for arc_deg, count, targets in ((30, 10, 1), (60, 10, 1), (60, 15, 6), (90, 15, 6),
                                    (100, 15, 6), (120, 20, 6)):  # fmt: skip
        cases = [base_frame_errors(seed, arc_deg, count, targets) for seed in range(40)]
        rms = np.sqrt(np.mean([case[0] ** 2 for case in cases], axis=0))
        nees = np.mean([base_frame_nees(*case) for case in cases]) / 6
        print(
            f"| {arc_deg}°, {count}, {targets} | {rms[:3].max() * 1e3:.3f} "
            f"| {np.degrees(rms[3:].max()):.4f} | {nees:.2f} |"
        )


def hand_eye() -> None:
    """Robot noise against closed form and maximum likelihood."""
    print("| poses, robot noise | closed form mm / ° | maximum likelihood mm / ° |")
    print("|---|---|---|")
    for count, position_mm, angle_deg in ((20, 0.0, 0.0), (20, 0.02, 0.002), (20, 0.05, 0.005),
                                          (20, 0.05, 0.03), (40, 0.05, 0.005)):  # fmt: skip
        pairs = [hand_eye_errors(seed, count, position_mm, angle_deg) for seed in range(30)]
        cells = [_rms_mm_deg(np.stack([pair[i] for pair in pairs])) for i in (0, 1)]
        print(f"| {count}, {position_mm} mm / {angle_deg}° | {cells[0]} | {cells[1]} |")


def _rms_mm_deg(errors: Array) -> str:
    squares = (errors**2).mean(axis=0)
    position_mm = np.sqrt(squares[:3].mean()) * 1e3
    return f"{position_mm:.3f} / {np.degrees(np.sqrt(squares[3:].mean())):.4f}"


STUDIES: dict[str, Callable[[], None]] = {
    "stereo": stereo,
    "hanging-together": hanging_together,
    "images": images,
    "base-frame": base_frame,
    "hand-eye": hand_eye,
}


def main() -> None:
    for name in sys.argv[1:] or STUDIES:
        print(f"\n## {name}")
        STUDIES[name]()


if __name__ == "__main__":
    main()
