"""The recording of a run comes back as it was written, and as far as it goes when it was cut."""

import io
from datetime import UTC, datetime

import numpy as np
import pytest
from mcap.reader import make_reader
from scipy.spatial.transform import RigidTransform

from cellctl.errors.records.store import RecordingUnreadable
from cellctl.interfaces import RobotMode, RobotState
from cellctl.records.files.mcap_reading import RecordedMessage, read_mcap
from cellctl.records.files.motion_file import MotionWriter

STARTED = datetime(2026, 11, 21, 12, 0, tzinfo=UTC)
START_S = 500.0


def state(time_s: float) -> RobotState:
    return RobotState(
        time_s=time_s,
        base_T_flange=RigidTransform.from_translation([1.0, 0.0, 1.5]),
        joints_rad=np.full(6, 0.3),
        mode=RobotMode.REMOTE,
        emergency_stop=False,
        drives_on=True,
        moving=True,
        stop_latched=False,
        error_code=0,
        speed_override_ratio=1.0,
    )


def recording(seconds: int = 2) -> bytes:
    file = io.BytesIO()
    writer = MotionWriter(file, STARTED, START_S)
    writer.command("main", START_S + 0.5, {"what": "step", "speed_mm_s": 2.0})
    for index in range(50 * seconds):
        writer.report("main", state(START_S + 0.02 * index))
    times_s = START_S + np.arange(1000 * seconds) / 1000
    raw = np.random.default_rng(1).normal(0.0, 10.0, (len(times_s), 6))
    writer.force("force", times_s, raw)
    writer.finish()
    return file.getvalue()


def of_topic(messages: tuple[RecordedMessage, ...], topic: str) -> list[RecordedMessage]:
    return [one for one in messages if one.topic == topic]


def test_everything_comes_back() -> None:
    content = read_mcap(recording())
    assert content.complete
    (command,) = of_topic(content.messages, "/robots/main/command")
    assert command.values == {"time_s": 0.5, "what": "step", "speed_mm_s": 2.0}
    reports = of_topic(content.messages, "/robots/main/report")
    assert len(reports) == 100
    assert reports[3].values["time_s"] == 0.06
    assert (reports[3].values["x_mm"], reports[3].values["z_mm"]) == (1000.0, 1500.0)
    assert reports[3].values["moving"] is True
    samples = of_topic(content.messages, "/force/force/raw")
    raw = np.random.default_rng(1).normal(0.0, 10.0, (2000, 6))
    np.testing.assert_allclose([one.values["fz_n"] for one in samples], raw[:, 2], atol=5e-5)


def test_message_times_are_those_of_the_wall_clock() -> None:
    """The schemas are what viewers expect, too; the reader of the format's authors reads it."""
    reader = make_reader(io.BytesIO(recording()))
    schemas = {schema.name: schema.encoding for schema, _, _ in reader.iter_messages() if schema}
    assert schemas == dict.fromkeys(("run.command", "run.report", "run.raw"), "jsonschema")
    first = min(message.log_time for _, _, message in reader.iter_messages())
    assert first == int(STARTED.timestamp() * 1e9)


@pytest.mark.parametrize("share", [0.4, pytest.param(0.9, marks=pytest.mark.figures)])
def test_a_cut_recording_is_read_up_to_the_cut(share: float) -> None:
    data = recording(20)
    content = read_mcap(data[: int(share * len(data))])
    assert not content.complete
    assert 0 < len(content.messages) < 21_001


@pytest.mark.parametrize("data", [b"", b"not a recording", recording()[:20]])
def test_what_is_no_recording_is_a_clear_fault(data: bytes) -> None:
    with pytest.raises(RecordingUnreadable):
        read_mcap(data)
