"""A run as a cell leaves it: motion, forces, registers, images and rims beside the record."""

import io
from collections.abc import Sequence
from datetime import timedelta

import numpy as np
import zstandard
from numpy.typing import NDArray

from cellctl.calibration.store.envelope import StoredCalibration
from cellctl.clock import now_s, utc_now
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.interfaces import RobotState
from cellctl.interfaces.robot import RobotMode
from cellctl.records import RunResult, RunStore
from cellctl.records.entries import PoseOrigin, RecordedPose
from cellctl.records.files.mcap_reading import MEDIA_TYPE
from cellctl.records.files.motion_file import MotionWriter
from cellctl.records.files.raw_images import MEDIA_TYPE as RAW_IMAGE
from cellctl.records.files.unfinished import MOTION
from cellctl.records.looks import MeasuredRim, TakenImage, documents_of_look
from tests.unit.records.sample import fill

Pixels = NDArray[np.uint8]

SAMPLES = 200
REPORTS = 20
PLACE = (1525.0, 12.5, 2110.0, 90.0, 1.5, 180.0)
ELSEWHERE = (-300.0, 0.0, 900.0, 0.0, 0.0, 0.0)
VIEW = "head-1-left"
FILE = f"raw/frame-frame-1-{VIEW}.pgm.zst"
PIXELS = np.random.default_rng(5).integers(0, 256, (40, 60), dtype=np.uint8)
RIMS = (
    MeasuredRim("P1", (20.5, 10.25), (0.02, 0.03), (20.4, 10.2), (6.0, 5.0), 0.3, 3.4),
    MeasuredRim("P2", (40.5, 20.25), (0.02, 0.03), (40.4, 20.2), (6.0, 5.0), 0.3, 41.0, used=False),
)
BASE_T_C1 = np.array(
    [[0.0, -1.0, 0.0, 1917.5], [1.0, 0.0, 0.0, -20.0], [0.0, 0.0, 1.0, 1500.0], [0, 0, 0, 1.0]]
)


def motion() -> bytes:
    """What a recorder writes: two robots, a sensor, states and registers."""
    file = io.BytesIO()
    start_s = now_s()
    writer = MotionWriter(file, utc_now(), start_s)
    for index, state in enumerate(("STARTING", "EXECUTE", "COMPLETING")):
        values = {"state": state, "state_requested": state, "mode": "PRODUCTION"}
        values |= {"step_label": "mate", "message": "creeps"}
        writer.note("/unit/state", start_s + index, {**values, "step": 50, "iteration": 0})
    writer.note("/registers/input", start_s, {"state": 3, "serial_echo": "SAT-0042"})
    writer.note("/registers/holding", start_s, {"cmd_seq": 2, "serial": "SAT-0042"})
    target = {"base_T_flange_mm_deg": list(PLACE), "speed_mm_s": 20.0, "acceleration_mm_s2": 50.0}
    writer.command("main", start_s, {"what": "move_linear", **target})
    writer.command("aux_1", start_s, {"what": "stop"})
    for name, place in (("main", PLACE), ("aux_1", ELSEWHERE)):
        for index in range(REPORTS):
            writer.report(name, report(start_s - 1.0 + 0.02 * index, place))
    times_s = start_s + 0.001 * np.arange(SAMPLES, dtype=np.float64)
    writer.force("force", times_s, np.tile([0.0, 1.0, -2.0, 0.0, 0.0, 0.1], (SAMPLES, 1)))
    writer.finish()
    return file.getvalue()


def report(time_s: float, place: tuple[float, ...]) -> RobotState:
    """State of a robot that stands."""
    return RobotState(
        time_s=time_s,
        joints_rad=np.zeros(6),
        base_T_flange=pose_from_xyzabc(place),
        mode=RobotMode.REMOTE,
        emergency_stop=False,
        drives_on=True,
        moving=False,
        stop_latched=False,
        error_code=0,
        speed_override_ratio=1.0,
    )  # fmt: skip


def open_run(store: RunStore, pixels: Pixels = PIXELS, rims: Sequence[MeasuredRim] = RIMS) -> int:
    """A run that is still open, with everything recorded but its motion."""
    now = utc_now()
    record = {"base_T_c1": {"matrix_mm": BASE_T_C1.tolist()}, "verdict": "pass"}
    kept = StoredCalibration("board_transfer", record, now, now + timedelta(days=9), "x", "S-1")
    store.add_calibration(kept)
    store.audit("line:10.0.0.5", "start", {"serial": "SAT-0042"})
    run = store.start_run(
        process="deck-to-frame", serial="SAT-0042", recipe_id=1, recipe_name="panel",
        recipe_hash="ab" * 32, mode="production", software="cellctl 0.1.0",
        config_hash="cd" * 32, calibration_ids={"board_transfer": kept.id}, simulated=True,
    )  # fmt: skip
    fill(store, run, b"\x89PNG\r\n\x1a\n")
    taken = {FILE: TakenImage("frame", VIEW, utc_now())}
    store.add(run, *documents_of_look("frame", taken, {VIEW: rims}))
    store.add(run, RecordedPose("frame", PoseOrigin.REPORTED, "base", "flange", PLACE))
    plain = b"P5 %d %d 255\n" % (pixels.shape[1], pixels.shape[0]) + pixels.tobytes()
    store.add_artefact(run, FILE, zstandard.compress(plain), RAW_IMAGE)
    store.add_alarm(run, 512, "F512 Force limit exceeded: 50.8 N")
    return run


def closed_run(store: RunStore) -> int:
    """The whole run, closed."""
    run = open_run(store)
    store.add_artefact(run, MOTION, motion(), MEDIA_TYPE)
    store.close_run(run, RunResult.GOOD)
    return run
