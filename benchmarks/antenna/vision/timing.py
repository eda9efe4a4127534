"""B15: how long looks take."""

import time
from collections.abc import Callable
from dataclasses import replace

import cv2
import numpy as np

from benchmarks.antenna.vision.report import Report
from cellctl.processes.antenna_module.vision.measure import measure_connector, measure_marks
from tests.rigs.antenna.pictures import CLEAN, Trial, trial

MARK_IMAGES, PLUG_IMAGES, SOCKET_IMAGES = 9, 3, 9
"""Images of one run, three frames a look: module on the tray twice and after the release, plug with
gripper marks once, socket three times. Whatever else is computed takes milliseconds."""
REPEATS = 5


def time_rows(report: Report) -> None:
    """B15: images of 5 megapixels on one processor, by the time that this process was given."""
    cv2.setNumThreads(1)
    large = replace(CLEAN, um_per_px=(25.0, 25.0), size_px=(2448, 2048))
    with_marks = trial(1, replace(large, marks=True))
    assert with_marks.marks is not None
    marks = with_marks.marks
    alone_s = _seconds(trial(1, large))
    both_s = _seconds(with_marks)
    marks_s = _median_s(
        lambda: measure_marks(with_marks.pixels.plane, with_marks.camera, with_marks.plane, marks)
    )
    _time_row(report, "one look at 5 MP", alone_s, 0.5)
    _time_row(report, "one look at 5 MP, contacts and gripper marks", both_s, 0.5)
    _time_row(report, "one look at 5 MP, marks alone", marks_s, 0.5)
    cycle_s = MARK_IMAGES * marks_s + PLUG_IMAGES * both_s + SOCKET_IMAGES * alone_s
    images = MARK_IMAGES + PLUG_IMAGES + SOCKET_IMAGES
    _time_row(report, f"a cycle's {images} images, one after another", cycle_s, 5.0)


def _time_row(report: Report, what: str, seconds: float, limit_s: float) -> None:
    report.row(
        "B15",
        what,
        REPEATS,
        demanded=f"≤ {limit_s:g} s of one core",
        default=f"{seconds:.2f} s",
        good=seconds <= limit_s,
    )


def _seconds(given: Trial) -> float:
    return _median_s(
        lambda: measure_connector(
            given.pixels.plane, given.camera, given.plane, given.connector, given.marks
        )
    )


def _median_s(measure: Callable[[], object]) -> float:
    """Processor time of one measurement, the median of several."""
    times = []
    for _ in range(REPEATS):
        begin = time.process_time()
        measure()
        times.append(time.process_time() - begin)
    return float(np.median(times))
