"""Turns the controller's numbers and the errors of sockets into numbered faults of the cell."""

import os

from cellctl.errors.base import CellError
from cellctl.errors.link import ConnectTimeout, LinkError, LinkLost
from cellctl.errors.robot import ControllerFault, MotionAborted, MotionRejected, RobotNotReady
from drivers.robot.siasun_rpc.vendor import TaskState, name

_ENDS: dict[int, tuple[type[CellError], str]] = {
    TaskState.PAUSED: (MotionAborted, "paused at the pendant; stopped here, not to be resumed"),
    TaskState.STOPPED: (MotionAborted, "stop was requested, or heartbeats stayed away"),
    TaskState.INTERRUPTED: (MotionAborted, "another task took its place; only this PC may move"),
    TaskState.ERROR: (ControllerFault, "look the vendor's text up and clear it at the pendant"),
    TaskState.ILLEGAL: (MotionRejected, "target out of reach, or not allowed in this state"),
    TaskState.PARAMETERS: (MotionRejected, "a parameter or a frame is not the controller's"),
}


def cannot_connect(peer: str, error: OSError) -> LinkError:
    """Nobody there, or nobody answers."""
    words = os.strerror(error.errno) if error.errno and error.errno > 0 else "no answer"
    return ConnectTimeout(f"{peer}: {words}")


def broken(peer: str, error: BaseException | None) -> LinkError:
    """A connection that stood has ended."""
    return LinkLost(f"{peer}: {error or 'closed by the controller'}")


def refused(robot: str, call: str, code: int, texts: list[str]) -> CellError:
    """A motion for which the controller has given no task."""
    return MotionRejected(f"{robot}: {call} was answered with {code}{_vendor_texts(texts)}")


def ended(robot: str, state: int, texts: list[str]) -> CellError:
    """A task whose state says that its target will not be reached."""
    fault, words = _ENDS.get(state, (MotionAborted, "no end that this driver knows"))
    return fault(f"{robot}: task {name(TaskState, state)}, {words}{_vendor_texts(texts)}")


def not_ready(robot: str, facts: str) -> RobotNotReady:
    """The controller would not move now."""
    return RobotNotReady(f"{robot}: {facts}; to be changed at the pendant")


def _vendor_texts(texts: list[str]) -> str:
    # The controller keeps a list; more than a few lines do not fit into an alarm.
    return f"; the controller says: {' | '.join(text[:120] for text in texts[:3])}" if texts else ""
