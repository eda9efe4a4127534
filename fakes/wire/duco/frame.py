"""The frame of the state stream (docs/protocols/siasun-rpc.md, section 5)."""

import struct

from fakes.wire.duco.logic import DucoLogic

SIZE = 1468
"""Bytes of a frame, which has neither header nor length."""
PERIOD_S = 0.1


def pack(logic: DucoLogic) -> bytes:
    """One frame of what the controller knows now; what this fake does not know is zero."""
    frame = bytearray(SIZE)
    wrong = logic.faults.active
    # Joints and pose stand there twice, as they are (0, 368) and as the controller expects them
    # (112, 464): this arm follows its own controller without a lag.
    struct.pack_into("<6f", frame, 0, *logic.joints())
    struct.pack_into("<6f", frame, 112, *logic.joints())
    struct.pack_into("<6f", frame, 368, *logic.pose())
    struct.pack_into("<6f", frame, 464, *logic.pose())
    override, collision, error = wrong("override"), wrong("collision"), wrong("vendor_error")
    frame[660] = int(override.number("percent", 50)) if override else 100
    frame[1407] = int(wrong("simulation") is not None)
    robot, program, safety, mode = logic.states()
    axis = int(collision.number("axis", 3)) if collision else 0
    flags = (mode, robot, program, safety, int(collision is not None), axis)
    code = int(error.number("code", 1001)) if error else 0
    struct.pack_into("<6BxxI", frame, 1448, *flags, code)
    return bytes(frame)
