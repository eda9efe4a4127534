"""``make bench-looks``: holes of many looks, drawn by a second renderer, against exact truth.

The feature file says what a drawing says and no more: kind, diameter, position. Not which way the
face looks, not how wide a countersink is.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # Threads only slow the small solves down.

import argparse
import sys

import cv2
import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.metrology.drawn_looks import LOOKS
from benchmarks.metrology.drawn_scenes import Scene, drawn_scene
from benchmarks.metrology.figures import HoleErrors
from cellctl.errors.vision import VisionError
from cellctl.vision.measure import measure_pair
from cellctl.vision.measurement import Method

MOST_SQUARED = 4.0
"""Mean normalised error squared, 2 expected: beyond this a look is not measured honestly."""


def measure(scene: Scene, errors: HoleErrors, method: Method, *, skip: int = 1) -> str | None:
    """Take in all holes but the first ``skip``; the reason when the scene is refused.

    The first hole of a drawn scene is plain and says nothing of its look.
    """
    view = scene.view
    try:
        result = measure_pair(*view.images, view.head, view.holes, method=method)
    except VisionError as fault:
        return str(fault)
    for hole in result.holes[skip:]:
        errors.add(view, hole, scene.steps[hole.name])
    return None


def row(look: str, count: int) -> tuple[list[str], bool]:
    """Figures of one look as text, and whether its uncertainties are honest."""
    errors: dict[Method, HoleErrors] = {"default": HoleErrors(), "paper": HoleErrors()}
    refused: dict[Method, int] = {"default": 0, "paper": 0}
    for seed in range(count):
        scene = drawn_scene(look, seed)
        for method, found in errors.items():
            refused[method] += measure(scene, found, method) is not None
    ours, paper = errors["default"], errors["paper"]
    theirs = f"{paper.median_ratio():.1f}" if paper.count else "-"
    figures = [look, f"{refused['default']} of {count}", f"{theirs}, {refused['paper']}"]
    if not ours.count:
        return figures, False
    squared = float(np.mean(ours.squared_2d))
    figures[1:1] = [
        f"{ours.median_ratio():.2f}",
        f"{ours.p95_px():.3f}",
        f"{ours.worst_px():.3f}",
        f"{squared:.2f}",
    ]
    return figures, squared < MOST_SQUARED


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-n", type=int, default=12, help="poses of each look")
    count = parser.parse_args().n
    cv2.setNumThreads(1)
    table = Table(
        "look", "median / CRLB", "p95, px", "worst, px", "error² of 2", "refused", "paper, refused"
    )
    honest = True
    for look in track(LOOKS, "looks", transient=True):
        figures, good = row(look, count)
        table.add_row(*figures)
        honest &= good
    Console(width=110).print(table)
    return 0 if honest else 1


if __name__ == "__main__":
    sys.exit(main())
