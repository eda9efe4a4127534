"""What the controller reports, against what a motion needs. Nothing is changed from here."""

from cellctl.errors.robot import ControllerFault, NotRearmed
from drivers.robot.siasun_rpc import faults
from drivers.robot.siasun_rpc.codec.state_frame import StateFrame
from drivers.robot.siasun_rpc.vendor import OperationMode, Power, SafetyState, name
from drivers.robot.siasun_rpc.watch import SAFE, Report


def check_ready(robot: str, report: Report, frame: StateFrame, error_words: str) -> None:
    """Raise ``NotRearmed``, ``ControllerFault`` or ``RobotNotReady`` when it may not move.

    ``error_words``: what is known of the frame's error number.
    """
    if report.guard_stopped:
        raise NotRearmed(f"{robot}: the guard has stopped the arm")
    if frame.error:
        raise ControllerFault(f"{robot}: controller error {error_words}")
    if frame.collision:
        raise faults.not_ready(robot, f"collision at axis {frame.collision_axis} is not cleared")
    if frame.simulated:
        raise faults.not_ready(robot, "the controller only simulates its motions")
    remote = report.mode == OperationMode.REMOTE
    if not (remote and report.power == Power.ENABLED and report.safety in SAFE):
        facts = (
            f"mode {name(OperationMode, report.mode)}, robot {name(Power, report.power)}, "
            f"safety {name(SafetyState, report.safety)}"
        )
        raise faults.not_ready(robot, facts)
