"""Recording of a run as it goes: what robots were told, where they were, what pushed.

Topics, all of JSON messages that common viewers plot:

- ``/robots/NAME/command``: each move that was asked for, when it was asked for;
- ``/robots/NAME/report``: each report of the controller;
- ``/force/NAME/raw``: each sample of a force sensor, in its own frame, before any tare;
- what the notes of the run name, such as ``/unit/state``: each change.

Message times are wall-clock times; ``time_s`` counts from the start of the recording.
"""

import json
from collections.abc import Mapping
from datetime import datetime
from typing import Any, BinaryIO

from mcap.writer import CompressionType, Writer

from cellctl.geometry.pose import Array, pose_to_xyzabc
from cellctl.interfaces.robot import RobotState

_CHUNK_BYTES = 64 * 1024
"""Half a second of a cell with one force sensor: what is lost of the last moments when the daemon
dies, since a chunk is written as a whole."""
_WRENCH = ("fx_n", "fy_n", "fz_n", "mx_n_m", "my_n_m", "mz_n_m")
_POSE = ("x_mm", "y_mm", "z_mm", "a_deg", "b_deg", "c_deg")
# A bool is an int too, hence first.
_JSON_TYPES = ((bool, "boolean"), (int, "integer"), (float, "number"), (str, "string"))


class MotionWriter:
    """Writes the messages of one run, compressed. Belongs to one thread at a time.

    Every method raises what the file raises, ``OSError``.
    """

    def __init__(self, file: BinaryIO, started: datetime, start_s: float) -> None:
        """``started`` is the wall-clock time of the monotonic ``start_s``."""
        self._start_ns, self._start_s = int(started.timestamp() * 1e9), start_s
        self._file = file
        self._writer = Writer(file, chunk_size=_CHUNK_BYTES, compression=CompressionType.ZSTD)
        self._writer.start(profile="", library="cellctl")
        self._channels: dict[str, int] = {}

    def command(self, robot: str, time_s: float, values: Mapping[str, Any]) -> None:
        """A move that was asked for; ``values`` are plain data with units in their names."""
        self._add(f"/robots/{robot}/command", time_s, values)

    def report(self, robot: str, state: RobotState) -> None:
        """A report of a controller."""
        pose = pose_to_xyzabc(state.base_T_flange)
        self._add(
            f"/robots/{robot}/report",
            state.time_s,
            # A micrometre and 0.1 mdeg are more than any controller states.
            dict(zip(_POSE, pose.round(4).tolist(), strict=True))
            | {
                "joints_rad": state.joints_rad.round(7).tolist(),
                "moving": state.moving,
                "stop_latched": state.stop_latched,
                "error_code": state.error_code,
                "override_ratio": round(state.speed_override_ratio, 3),
            },
        )

    def force(self, sensor: str, times_s: Array, raw: Array) -> None:
        """Samples of a force sensor: ``times_s`` (n,), ``raw`` (n, 6) in N and N·m."""
        # Four decimals are 0.1 mN, far below the noise of a sensor.
        for time_s, wrench in zip(times_s.tolist(), raw.round(4).tolist(), strict=True):
            values = dict(zip(_WRENCH, wrench, strict=True))
            self._add(f"/force/{sensor}/raw", time_s, values)

    def note(self, topic: str, time_s: float, values: Mapping[str, Any]) -> None:
        """A topic of the unit or the line; ``values`` are plain data with units in their names."""
        self._add(topic, time_s, values)

    def flush(self) -> None:
        """Hand whole chunks to the kernel: what it has outlives this process."""
        self._file.flush()

    def finish(self) -> None:
        """Write the end of the file; nothing may be added afterwards."""
        self._writer.finish()

    def _add(self, topic: str, time_s: float, values: Mapping[str, Any]) -> None:
        since_s = time_s - self._start_s
        message = {"time_s": round(since_s, 6), **values}
        time_ns = self._start_ns + int(since_s * 1e9)
        self._writer.add_message(
            self._channel(topic, message), time_ns, json.dumps(message).encode(), time_ns
        )

    def _channel(self, topic: str, message: Mapping[str, Any]) -> int:
        if topic not in self._channels:
            title = "run." + topic.rsplit("/", 1)[-1]
            properties = {name: {"type": _json_type(value)} for name, value in message.items()}
            schema = json.dumps({"title": title, "type": "object", "properties": properties})
            schema_id = self._writer.register_schema(title, "jsonschema", schema.encode())
            self._channels[topic] = self._writer.register_channel(topic, "json", schema_id)
        return self._channels[topic]


def _json_type(value: object) -> str:
    return next((name for kind, name in _JSON_TYPES if isinstance(value, kind)), "array")
