"""The frames of the state stream: 1468 bytes ten times a second, without header or length.

Only their size tells one from the next, so a reader that joins at the wrong byte would be wrong for
ever. A stream that says impossible things is given up here; one that says possible things is also
compared with the answers of the service (``watch``). Offsets: docs/protocols/siasun-rpc.md,
section 5.
"""

import math
import struct
from dataclasses import dataclass

from cellctl.errors.link import ProtocolViolation

FRAME_BYTES = 1468
_JOINTS = struct.Struct("<6f")
_POSE_AT = 368
_OVERRIDE_AT = 660
_SIMULATION_AT = 1407
_FLAGS = struct.Struct("<6BxxI")
"""Mode, robot, program, safety, collision, its axis; then the vendor's error number."""
_FLAGS_AT = 1448
_MAX_JOINT_RAD = 4.0 * math.pi
_MAX_PLACE_M = 10.0


@dataclass(frozen=True, slots=True)
class StateFrame:
    """What this driver takes from a frame."""

    joints_rad: tuple[float, ...]
    """Six joints; the seventh place is empty on an arm with six."""
    override_percent: int
    simulated: bool
    mode: int
    power: int
    program: int
    safety: int
    collision: bool
    collision_axis: int
    error: int


class FrameReader:
    """Splits the state stream into frames: bytes go in with ``feed``, frames come out with
    ``next``."""

    def __init__(self) -> None:
        self._buffer = b""

    def feed(self, data: bytes) -> None:
        """Take what has arrived."""
        self._buffer += data

    def next(self) -> StateFrame | None:
        """The next frame, None while it is not whole; ``ProtocolViolation`` for an impossible one.

        The stream may not be read on after that: where its frames begin is not known any more.
        """
        if len(self._buffer) < FRAME_BYTES:
            return None
        data, self._buffer = self._buffer[:FRAME_BYTES], self._buffer[FRAME_BYTES:]
        return parse(data)


def parse(data: bytes) -> StateFrame:
    """One frame of ``FRAME_BYTES`` bytes."""
    joints_rad = _JOINTS.unpack_from(data, 0)
    place_m = struct.unpack_from("<3f", data, _POSE_AT)
    mode, power, program, safety, collision, axis, error = _FLAGS.unpack_from(data, _FLAGS_AT)
    override = data[_OVERRIDE_AT]
    # Written so that what is not a number is refused.
    possible = (
        all(abs(angle) <= _MAX_JOINT_RAD for angle in joints_rad)
        and all(abs(value) <= _MAX_PLACE_M for value in place_m)
        and override <= 100
        and collision <= 1
        and data[_SIMULATION_AT] <= 1
    )
    if not possible:
        raise ProtocolViolation("state frame with impossible values, or not at its first byte")
    return StateFrame(
        joints_rad=joints_rad,
        override_percent=override,
        simulated=bool(data[_SIMULATION_AT]),
        mode=mode,
        power=power,
        program=program,
        safety=safety,
        collision=bool(collision),
        collision_axis=axis,
        error=error,
    )
