"""A run with everything in it, made from plausible figures."""

from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np

from cellctl.calibration.store.envelope import StoredCalibration
from cellctl.force.contact.curve import ForceCurve
from cellctl.records import RunResult, RunStore
from cellctl.records.entries import (
    PRODUCTION,
    Document,
    LoopPass,
    PassComponent,
    PoseOrigin,
    RecordedPose,
)
from cellctl.records.figures import Limit, figure
from cellctl.records.files.curve_file import encode_curve
from cellctl.records.files.mcap_reading import MEDIA_TYPE

PROCESS = "deck-to-frame"
THRESHOLD = (0.05, 0.05, 0.05, 0.005, 0.005, 0.005)
SIGMA = (0.004, 0.004, 0.006, 0.0006, 0.0004, 0.0003)
ERRORS = (
    (1.2143, -0.8712, 0.4321, 0.08123, -0.04321, 0.12011),
    (0.0712, -0.0431, 0.0122, 0.00712, -0.00213, 0.00481),
    (0.0081, -0.0112, 0.0043, 0.00112, -0.00083, 0.00041),
)
LOOP = "pose correction"
COMPONENTS = (
    ("X", "mm"), ("Y", "mm"), ("Z", "mm"), ("rx", "°"), ("ry", "°"), ("rz", "°"),
)  # fmt: skip
HOLE = {
    "head": 1, "position_mm": [10.123, -20.456, 512.789], "sigma_mm": [0.002, 0.002, 0.006],
    "diameter_mm": 6.003, "left_px": [1000.1, 900.2], "right_px": [1100.3, 900.4],
}  # fmt: skip


def force_curve(peak_n: float = 38.0, seconds: float = 24.0, step_s: float = 0.001) -> ForceCurve:
    """Approach, touch, creep to force, hold."""
    time_s = np.arange(0, seconds, step_s)
    travel_m = np.minimum(time_s * 0.5e-3, 10.02e-3)
    touch_s = 0.82 * seconds
    force = np.clip((time_s - touch_s) / 1.5, 0, 1) * peak_n * 0.93
    force += np.where(np.abs(time_s - touch_s - 1.6) < 0.05, peak_n * 0.07, 0.0)
    rng = np.random.default_rng(3)
    wrench = rng.normal(0, 0.25, (len(time_s), 6)) * [1, 1, 1, 0.05, 0.05, 0.05]
    wrench[:, 2] += force
    wrench[:, 0] += 0.03 * force
    return ForceCurve(time_s, wrench, travel_m)


def pose(key: str, values: tuple[float, ...], residual_um: float, **more: Any) -> RecordedPose:
    """A part as head 1 saw it."""
    return RecordedPose(
        key, PoseOrigin.MEASURED, "c1", key, values, SIGMA, residual_um=residual_um, frames=2,
        **more,
    )  # fmt: skip


def loop_pass(
    number: int, errors: tuple[float, ...], corrections: tuple[float | None, ...] = (None,) * 6
) -> LoopPass:
    """One pass of the loop of an assembly; the last one of ``ERRORS`` has converged."""
    columns = zip(COMPONENTS, errors, SIGMA, THRESHOLD, corrections, strict=True)
    components = tuple(PassComponent(*head, *values) for head, *values in columns)
    return LoopPass(
        LOOP, number, components, number == len(ERRORS), residual_um=3.0 + number, frames=2
    )


def fill(store: RunStore, run: int, picture: bytes) -> None:
    """Everything that a good run leaves behind."""
    store.begin_phase(run, 10, "measure frame")
    store.add(run, pose("frame", (12.34, -4.56, 512.3, 90.01, 0.02, 179.9), 3.4))
    store.begin_phase(run, 20, "measure deck")
    detail = {
        "holes": dict.fromkeys(("P1", "P2", "P5", "P6"), HOLE),
        "residuals_mm": {"P1": [0.001, 0.002, 0.002], "P5": [0.0, 0.0, 0.009]},
        "outliers": ["P5"],
    }
    store.add(run, pose("deck", (10.1, -3.3, 447.2, 89.8, 0.1, 179.7), 4.1, detail=detail))
    store.begin_phase(run, 40, "correct pose")
    store.add(run, *(loop_pass(number, error) for number, error in enumerate(ERRORS, start=1)))
    for name in ("head-1-left", "head-1-right", "head-2-left", "head-2-right"):
        store.add_artefact(run, f"frame-{name}.png", picture, "image/png")
    store.begin_phase(run, 50, "mate")
    # Of fewer samples than a sensor has: to write them took longer than all else of the run.
    felt = force_curve(seconds=4.0, step_s=0.004)
    recording = encode_curve(felt, datetime.now(UTC), {"attempt": "1"})
    store.add_artefact(run, "force-1.mcap", recording, MEDIA_TYPE)
    store.add(
        run,
        figure("target_force", 35.0, "N"),
        figure("limit_force", 50.0, "N"),
        figure("peak_force", 38.4, "N", limit=Limit(upper=50.0)),
        figure("approach.speed", 0.2512, "mm/s"),
        figure("stop_latency", 250.0, "ms"),
        figure("stiffness", 812.4, "N/mm"),
        figure("verdict.depth_error", 0.012, "mm"),
        Document(
            "mating",
            {
                "approach": {"formula": "F_peak = h(k v) + k v T + F_tare"},
                "verdict": {"seated": True},
            },
        ),
    )


def calibrations(store: RunStore) -> dict[str, str]:
    """Store a stereo head and a transfer; their ids by kind."""
    now = datetime.now(UTC)
    camera = {"camera_matrix": [[3581.2, 0, 1224.3], [0, 3580.9, 995.1], [0, 0, 1]]}
    covariance = np.diag([1e-4] * 3 + [1e-8] * 3).tolist()
    records: dict[str, dict[str, Any]] = {
        "head_1": {
            "verdict": "pass", "left": camera, "right": camera, "rms_px": 0.0312,
            "rotation": [[0.9397, 0, 0.342], [0, 1, 0], [-0.342, 0, 0.9397]],
            "translation_mm": [-176.3, 0.1, 31.1], "checks": [{"passed": True}] * 4,
        },
        "board_transfer": {
            "verdict": "pass", "checks": [{"passed": True}],
            "c1_T_c2": {"xyz_abc_mm_deg": [-712.3, 12.1, 3.2, 179.9, 0.1, -0.2],
                        "covariance_mm_deg": covariance},
        },
    }  # fmt: skip
    ids = {}
    for kind, record in records.items():
        stored = StoredCalibration(kind, record, now, now + timedelta(days=180), "cellctl", "S-1")
        store.add_calibration(stored)
        ids[kind] = stored.id
    return ids


def good_run(store: RunStore, picture: bytes = b"\x89PNG\r\n\x1a\n") -> int:
    """A whole good run; its number."""
    run = store.start_run(
        process=PROCESS, serial="SAT-0042", recipe_id=1, recipe_name="panel 500 x 1000",
        recipe_hash="ab" * 32,
        mode=PRODUCTION, software="cellctl 0.1.0", config_hash="cd" * 32,
        calibration_ids=calibrations(store), simulated=True, operator="OP-7",
    )  # fmt: skip
    fill(store, run, picture)
    store.close_run(run, RunResult.GOOD)
    store.set_gauge(run, "P1", 5.95, "simulator")
    store.set_gauge(run, "P5", 5.93, "simulator")
    return run
