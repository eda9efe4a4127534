"""SJL/1 records that the PC sends, as bytes, without I/O (docs/protocols/sjl-1.md).

What the robot sends is read by ``decoder.py``. Both are shared by the driver and by the guard's
stop channel, so they stay free of arrays.
"""

from collections.abc import Sequence

from drivers.robot.siasun.codec.records import StreamFigures

VERSION = "1"
least_acceleration_mm_s2 = 0.0
"""A word of SJL/1 says any acceleration."""


def accept_hello(session: int) -> bytes:
    """OK,HELLO: accept a robot and give it the number of its session."""
    return _encode("OK", "HELLO", VERSION, str(session))


def refuse_hello(reason: str) -> bytes:
    """NO,HELLO; the PC closes after it."""
    return _encode("NO", "HELLO", reason)


def move_joint(session: int, seq: int, joints_deg: Sequence[float], percent: int) -> bytes:
    """MOVJ: move to joint angles in degrees, J1 to J6, at a percentage of the rated speed."""
    joints = [_fixed(value, 5) for value in joints_deg]
    return _encode("MOVJ", str(session), str(seq), *joints, str(percent))


def move_linear(
    session: int, seq: int, xyzabc: Sequence[float], speed_mm_s: float, acceleration_mm_s2: float
) -> bytes:
    """MOVL: straight move to a flange pose in mm and degrees; ends at standstill."""
    numbers = [_fixed(value, 4) for value in (*xyzabc, speed_mm_s, acceleration_mm_s2)]
    return _encode("MOVL", str(session), str(seq), *numbers)


def step(session: int, seq: int, xyzabc: Sequence[float], speed_mm_s: float) -> bytes:
    """STEP: like MOVL, but refused by the controller when it is longer than its greatest step."""
    numbers = [_fixed(value, 4) for value in (*xyzabc, speed_mm_s)]
    return _encode("STEP", str(session), str(seq), *numbers)


def rearm(session: int, seq: int) -> bytes:
    """REARM: release the controller's stop latch; moves nothing."""
    return _encode("REARM", str(session), str(seq))


def begin_stream(session: int, seq: int, figures: StreamFigures) -> bytes:
    """STREAM: begin a stream of setpoints with these limits."""
    lengths = (figures.step_mm, figures.step_deg, figures.travel_mm, figures.travel_deg)
    numbers = [_fixed(value, 4) for value in lengths]
    return _encode("STREAM", str(session), str(seq), *numbers, str(figures.loss_ms))


def set_point(session: int, number: int, xyzabc: Sequence[float]) -> bytes:
    """SET: the setpoint for tick ``number``, in mm and degrees."""
    return _encode("SET", str(session), str(number), *(_fixed(value, 4) for value in xyzabc))


def finish_stream(session: int, seq: int) -> bytes:
    """FINISH: end the stream that has this number, at standstill."""
    return _encode("FINISH", str(session), str(seq))


def beat(session: int, count: int) -> bytes:
    """BEAT: heartbeat, without which the controller's dead man stops the arm."""
    return _encode("BEAT", str(session), str(count))


def abort(session: int, abort_id: int) -> bytes:
    """ABORT: stop now and latch; the same ``abort_id`` may be repeated."""
    return _encode("ABORT", str(session), str(abort_id))


def _encode(*fields: str) -> bytes:
    body = ",".join(fields).encode("ascii")
    return b"%b*%02X\n" % (body, sum(body) & 0xFF)


def _fixed(value: float, decimals: int) -> str:
    # A small negative number would be written as ``-0.0000``, which the protocol does not allow
    # (section 2).
    text = f"{value:.{decimals}f}"
    return text.removeprefix("-") if float(text) == 0.0 else text
