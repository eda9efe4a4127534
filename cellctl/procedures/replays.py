"""Computes the recorded runs of these procedures anew: what they measured, and their results.

Each function takes the name under which the process stores the result, and raises
``NotReplayable`` for a run without the readings, and the faults of its solver.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.arm_reference import target_offsets
from cellctl.calibration.boards.board_images import BoardImages, detect_view
from cellctl.calibration.boards.board_pose import BoardPose
from cellctl.calibration.boards.board_record import board_from_record
from cellctl.calibration.solvers.base_frame.base_frame import ArmGeometry, calibrate_base_frame
from cellctl.calibration.solvers.stereo.stereo import calibrate_stereo
from cellctl.config.devices import LoadConfig
from cellctl.errors.records.store import RecordingUnreadable
from cellctl.force.gravity.payload_result import payload_document
from cellctl.force.gravity.pose_file import PoseRecord
from cellctl.force.gravity.poses import PoseRole
from cellctl.geometry.pose import pose_to_xyzabc
from cellctl.geometry.units import in_mm_deg
from cellctl.procedures.arm_reference import offset_figures
from cellctl.procedures.base_frame import axis_stops
from cellctl.procedures.input_forms import look_from_input
from cellctl.procedures.payload import weighed
from cellctl.procedures.stereo_head import view_name
from cellctl.procedures.stop_latency_result import StopLatency, TimedStop
from cellctl.records.files.mcap_reading import read_mcap
from cellctl.records.files.unfinished import MOTION
from cellctl.records.replay.procedure_result import compare_result
from cellctl.records.replay.recorded_run import RecordedRun
from cellctl.records.replay.replayed import SOLVED, Replayed, compare, solved

POSE = (("X", "mm"), ("Y", "mm"), ("Z", "mm"), ("A", "°"), ("B", "°"), ("C", "°"))
SIGMA = (
    ("σ X", "mm"), ("σ Y", "mm"), ("σ Z", "mm"), ("σ rx", "°"), ("σ ry", "°"), ("σ rz", "°"),
)  # fmt: skip
WRENCH = (
    ("fx_n", "N"), ("fy_n", "N"), ("fz_n", "N"), ("mx_n_m", "N·m"), ("my_n_m", "N·m"),
    ("mz_n_m", "N·m"),
)  # fmt: skip
"""Keys of a sample in the recording of a run, with their units."""
FORCE_RESOLUTION = 1e-4
"""Samples are recorded with four decimals."""
TIME_RESOLUTION_S = 1e-6


def replay_head(run: RecordedRun, name: str) -> Iterator[Replayed]:
    """The cameras of a head from the images of the board."""
    given = run.input
    run.require(file for pair in given["pairs"] for file in pair)
    board = board_from_record(given["board"])
    views, image_size = [], (0, 0)
    for number, (left, right) in enumerate(given["pairs"], start=1):
        images = BoardImages(view_name(number), run.image(left), run.image(right))
        image_size = (images.left.shape[1], images.left.shape[0])
        view = detect_view(images, board)
        if view is not None:
            views.append(view)
    yield from compare_result(run, name, calibrate_stereo(views, board, image_size).to_record())


def replay_base_frame(run: RecordedRun, name: str) -> Iterator[Replayed]:
    """The base in the large-field head, from the targets at every stop."""
    given = run.input
    a1_stops, a2_stops = (
        axis_stops([look_from_input(look) for look in given[stops]])
        for stops in ("a1_stops", "a2_stops")
    )
    found = calibrate_base_frame(a1_stops, a2_stops, ArmGeometry(**given["arm"]))
    result = replace(found, reference=look_from_input(given["reference"]))
    yield from compare_result(run, name, result.to_record())


def replay_arm_reference(run: RecordedRun) -> Iterator[Replayed]:
    """How far each target is from its place."""
    then, now = (look_from_input(run.input[look]) for look in ("then", "now"))
    for entry in offset_figures(target_offsets(then, now)):
        recorded = run.record.value(entry.key)
        yield Replayed("targets", entry.label, entry.unit, recorded, entry.value, solved(recorded))


def replay_payload(run: RecordedRun, name: str) -> Iterator[Replayed]:
    """The mean wrench of each pose from the recording of the run, then the payload."""
    given = run.input
    yield from _still_wrenches(run, given)
    poses = PoseRecord(
        Rotation.from_quat([pose["base_R_sensor_xyzw"] for pose in given["poses"]]),
        np.array([_wrench(pose) for pose in given["poses"]], float),
        tuple(PoseRole(pose["role"]) for pose in given["poses"]),
    )
    load = None if given["load"] is None else LoadConfig.model_validate(given["load"])
    flange_T_sensor = RigidTransform.from_matrix(np.array(given["flange_T_sensor"], float))
    yield from compare_result(run, name, payload_document(weighed(poses, load, flange_T_sensor)))


def replay_stop_latency(run: RecordedRun, name: str) -> Iterator[Replayed]:
    """The overrun of each stop from what the robot has reported, and the latency from all."""
    given = run.input
    stops = [TimedStop.from_input(stop) for stop in given["stops"]]
    measured = StopLatency.of(stops, np.array(given["direction"], float))
    record = measured.to_record(measured.checks(given["bound_ms"]))
    yield from compare_result(run, name, record)


def compare_board(name: str, recorded: BoardPose, computed: BoardPose) -> Iterator[Replayed]:
    """The pose of a board in the frame of a head, and how certain it is."""
    was, found = recorded.head_T_board, computed.head_T_board
    poses = pose_to_xyzabc(was.pose).tolist(), pose_to_xyzabc(found.pose).tolist()
    yield from compare(name, POSE, *poses, SOLVED)
    sigmas = in_mm_deg(was.sigma).tolist(), in_mm_deg(found.sigma).tolist()
    yield from compare(name, SIGMA, *sigmas, SOLVED)


def _still_wrenches(run: RecordedRun, given: Mapping[str, Any]) -> Iterator[Replayed]:
    times_s, wrenches = _samples(run, given["sensor"])
    for number, pose in enumerate(given["poses"], start=1):
        measurement = f"pose {number}"
        # Without a recording of the run none of the samples is there.
        from_s, to_s = pose["from_s"] or np.inf, pose["to_s"] or -np.inf
        inside = (times_s > from_s - TIME_RESOLUTION_S) & (times_s < to_s + TIME_RESOLUTION_S)
        yield Replayed(measurement, "samples", "", pose["samples"], int(inside.sum()))
        if inside.any():
            mean = wrenches[inside].mean(axis=0).tolist()
            yield from compare(measurement, WRENCH, _wrench(pose), mean, FORCE_RESOLUTION)


def _wrench(pose: Mapping[str, Any]) -> list[float]:
    """The mean that the procedure took at one pose: N and N·m, shape (6,)."""
    return [*pose["force_n"], *pose["moment_n_m"]]


def _samples(run: RecordedRun, sensor: str) -> tuple[np.ndarray, np.ndarray]:
    """Times (n,) and raw wrenches (n, 6) of a force sensor in the recording of the run."""
    topic = f"/force/{sensor}/raw"
    try:
        messages = read_mcap(run.file(MOTION)).messages if run.has(MOTION) else ()
    except RecordingUnreadable:
        messages = ()
    rows = [
        [one.values["time_s"], *(one.values[key] for key, _ in WRENCH)]
        for one in messages
        if one.topic == topic
    ]
    table = np.array(rows, float).reshape(-1, 1 + len(WRENCH))
    return table[:, 0], table[:, 1:]
