"""Turns the controller's words and the errors of sockets into numbered faults of the cell.

The guard process imports this module for its stop channel, so it imports no arrays; they are named
in annotations only.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from cellctl.errors.base import CellError
from cellctl.errors.link import PortInUse
from cellctl.errors.robot import (
    ControllerFault,
    MotionAborted,
    MotionRejected,
    NotRearmed,
    RobotNotReady,
    SetpointRefused,
    StreamNotOffered,
    StreamStale,
)

if TYPE_CHECKING:
    from cellctl.interfaces.robot import RobotState

_REJECTIONS: dict[str, tuple[type[CellError], str]] = {
    "SESSION": (MotionRejected, "command of another session"),
    "SEQ": (MotionRejected, "sequence number out of order"),
    "BUSY": (MotionRejected, "another motion is running"),
    "LATCHED": (NotRearmed, "the controller's stop latch is set"),
    "MODE": (RobotNotReady, "not in remote mode"),
    "ESTOP": (RobotNotReady, "emergency stop is active"),
    "DRIVES": (RobotNotReady, "drives are off"),
    "ERROR": (ControllerFault, "controller error is active"),
    "LIMIT": (MotionRejected, "joint limit"),
    "REACH": (MotionRejected, "target out of reach"),
    "SINGULAR": (MotionRejected, "path through a singularity"),
    "SPEED": (MotionRejected, "speed or acceleration not allowed"),
    "STEP": (MotionRejected, "step too long or turns too far"),
    "LOAD": (MotionRejected, "load not allowed"),
    "STREAM": (StreamNotOffered, "stream not offered like this"),
}

_ABORTS: dict[str, tuple[type[CellError], str]] = {
    "STOP": (MotionAborted, "stop was requested"),
    "DEADMAN": (MotionAborted, "heartbeat of this PC stayed away"),
    "LINK": (MotionAborted, "the robot lost one of its channels"),
    "ESTOP": (MotionAborted, "emergency stop"),
    "MODE": (MotionAborted, "operating mode was changed"),
    "DRIVES": (MotionAborted, "drives went off"),
    "ERROR": (ControllerFault, "controller error during the motion"),
    "STALE": (StreamStale, "no setpoint within the time of the stream"),
    "STEP": (SetpointRefused, "setpoint too far from the one before"),
    "TRAVEL": (SetpointRefused, "setpoint too far from the beginning of the stream"),
    "LIMIT": (SetpointRefused, "joint limit"),
    "REACH": (SetpointRefused, "setpoint out of reach"),
    "SINGULAR": (SetpointRefused, "setpoint near a singularity"),
}


def rejection(robot: str, reason: str) -> CellError:
    """Fault of ``REJ,<seq>,<reason>``."""
    # A job program may know more reasons than this driver; an unknown one is still a refusal, with
    # its word in the text.
    fault, words = _REJECTIONS.get(reason, (MotionRejected, "reason unknown to this driver"))
    return fault(f"{robot}: {words} ({reason})")


def abortion(robot: str, reason: str) -> CellError:
    """Fault of ``ABRT,<seq>,<reason>,…``."""
    fault, words = _ABORTS.get(reason, (MotionAborted, "reason unknown to this driver"))
    return fault(f"{robot}: {words} ({reason})")


def check_ready(robot: str, state: RobotState, missed_beats: str) -> None:
    """Raise ``NotRearmed``, ``ControllerFault`` or ``RobotNotReady`` when it may not move."""
    if state.stop_latched:
        why = f"; {missed_beats}" if missed_beats else ""
        raise NotRearmed(f"{robot}: the controller's stop latch is set{why}")
    if state.error_code:
        raise ControllerFault(f"{robot}: controller error {state.error_words}")
    if not state.ready:
        raise _not_ready(robot, state)


def _not_ready(robot: str, state: RobotState) -> CellError:
    drives = "on" if state.drives_on else "off"
    button = "active" if state.emergency_stop else "released"
    return RobotNotReady(
        f"{robot}: mode {state.mode.value}, drives {drives}, emergency stop {button}"
    )


def cannot_listen(host: str, port: int, error: OSError) -> CellError:
    """Fault of a listening socket that could not be had."""
    words = os.strerror(error.errno) if error.errno and error.errno > 0 else str(error)
    return PortInUse(f"cannot listen on {host}:{port}: {words}")
