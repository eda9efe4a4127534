"""What a controller must refuse by itself, although the driver would never send it.

The driver looks at the state before it sends anything, so these commands go out behind its back: a
state may be older than what it does not yet show, and a driver may be wrong.
"""

from collections.abc import Callable
from dataclasses import dataclass

from cellctl.errors.base import CellError
from cellctl.errors.robot import ControllerFault, MotionRejected, NotRearmed, RobotNotReady
from cellctl.geometry.pose import pose_to_xyzabc
from tests.rigs.wire.any_rig import AnyRig, above

_SPEED_MM_S, _ACCELERATION_MM_S2 = 20.0, 200.0


@dataclass(frozen=True, slots=True)
class Refusal:
    """A command, what makes it wrong, and what the driver raises."""

    fault: type[CellError]
    send: Callable[[AnyRig], Callable[[int, int], bytes]]
    """Prepares the rig; the record of a session and a number."""
    words: str = ""
    """Words in the fault's detail; the reason of the refusal where there are none."""


def _move(
    rig: AnyRig, *, session: int = 0, speed: float = _SPEED_MM_S
) -> Callable[[int, int], bytes]:
    """A straight move, in a session that is so much beside the present one."""
    target = pose_to_xyzabc(above(rig, 10.0)).tolist()
    words = rig.robot._command.words
    return lambda this, seq: words.move_linear(
        this + session, seq, target, speed, _ACCELERATION_MM_S2
    )


def _number(beside: int) -> Callable[[AnyRig], Callable[[int, int], bytes]]:
    """The driver counts so much beside the controller."""

    def send(rig: AnyRig) -> Callable[[int, int], bytes]:
        rig.robot._command._seq += beside
        return _move(rig)

    return send


def _turned(rig: AnyRig) -> Callable[[int, int], bytes]:
    """A step that hardly goes anywhere and turns by more than half a degree."""
    target = pose_to_xyzabc(rig.robot.state().base_T_flange)
    target[3] += 0.6
    words = rig.robot._command.words
    return lambda session, seq: words.step(session, seq, target.tolist(), _SPEED_MM_S)


def _panel(fault: str) -> Callable[[AnyRig], Callable[[int, int], bytes]]:
    """Somebody at the panel was quicker than the report of it."""

    def send(rig: AnyRig) -> Callable[[int, int], bytes]:
        build = _move(rig)
        rig.controller.faults.inject(fault)
        return build

    return send


REFUSALS: dict[str, Refusal] = {
    "DUP": Refusal(MotionRejected, _number(-1), "used before"),
    "SEQ": Refusal(MotionRejected, _number(+1)),
    "SESSION": Refusal(MotionRejected, lambda rig: _move(rig, session=1)),
    "SPEED": Refusal(MotionRejected, lambda rig: _move(rig, speed=0.0)),
    "STEP": Refusal(MotionRejected, _turned),
    "ESTOP": Refusal(RobotNotReady, _panel("emergency_stop")),
    "MODE": Refusal(RobotNotReady, _panel("manual_mode")),
    "DRIVES": Refusal(RobotNotReady, _panel("drives_off")),
    "ERROR": Refusal(ControllerFault, _panel("vendor_error")),
    "LATCHED": Refusal(NotRearmed, _move),
}
"""Refusals by their reason, also a label of the main job. Before ``LATCHED`` the arm was
stopped."""
