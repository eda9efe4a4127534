"""3xx: robot controllers and motion."""

from cellctl.errors.base import CellError, Reaction


class RobotError(CellError):
    """A robot refused, failed or was stopped."""


class MotionRejected(RobotError):
    """The controller refused a motion command."""

    number = 301
    text = "Robot refused a motion"
    cause = "Target unreachable, joint limit, wrong frame or speed, or a stale command."
    remedy = "See the controller's reason in the detail; check the target pose."


class MotionAborted(RobotError):
    """A running motion ended before its target."""

    number = 302
    text = "Robot stopped before reaching its target"
    cause = "Stop requested by the guard, the operator or the controller."
    remedy = "See the reason in the detail and the force curve if there is one."


class RobotNotReady(RobotError):
    """The controller cannot move now: mode, drives, e-stop or error."""

    number = 303
    text = "Robot is not ready to move"
    cause = "Not in remote mode, drives off, emergency stop, or an active controller error."
    remedy = "Restore the controller's state on its panel; then Clear and Reset."


class StopFailed(RobotError):
    """Standstill was not confirmed after a stop request."""

    number = 304
    text = "Robot did not confirm a stop"
    cause = "Lost link or hung controller program."
    remedy = "Use the emergency stop. No Clear before the robot is known to stand still."


class TargetOutOfBounds(RobotError):
    """A target lies outside the site's motion bounds and was not sent."""

    number = 305
    text = "A motion target lies outside its bounds"
    cause = "Wrong calibration, recipe or taught pose, or an implausible measurement."
    remedy = (
        "Check calibration and recipe, and the measurement's pictures. After a joint move: teach "
        "the pose again, or jog the arm to a taught pose from which its way is free."
    )


class NotRearmed(RobotError):
    """A motion was commanded while a stop is latched."""

    number = 306
    text = "Robot stop is latched"
    cause = "A stop was requested and nobody has re-armed the robot since."
    remedy = "Clear, then Reset: the cell re-arms the robot."


class ControllerFault(RobotError):
    """The controller reports an error of its own."""

    number = 307
    text = "Robot controller reports an error"
    cause = "See the vendor's code in the detail."
    remedy = "Look the code up in the controller's manual and clear it there."


class HeadMoved(RobotError):
    """A measuring head moved between two measurements that must share a pose."""

    number = 308
    text = "A measuring robot moved between measurements"
    cause = "Brake slip, a manual jog, or a collision."
    remedy = "Start the run again; if it recurs check the auxiliary robot."
    reaction = Reaction.STOP


class SpeedOverridden(RobotError):
    """The speed override on the panel is not at 100 %."""

    number = 309
    text = "Robot's speed override is not 100 %"
    cause = "Somebody turned it on the panel; measured stops and planned contacts count on it."
    remedy = "Set the override on the robot's panel to 100 %, then start again."
    reaction = Reaction.STOP


class StreamNotOffered(RobotError):
    """Streamed motion was asked of a robot that cannot do it."""

    number = 310
    text = "Robot does not offer streamed motion"
    cause = "The job program on the controller is an older one or was loaded without this option."
    remedy = "Load a job program with streamed motion, or choose a process that needs none."
    reaction = Reaction.STOP


class StreamStale(RobotError):
    """The robot heard no setpoint for longer than the stream allows, and stopped."""

    number = 311
    text = "Streamed setpoints stayed away and the robot stopped"
    cause = "This PC was too busy, or the network between PC and robot was interrupted."
    remedy = "Look at load and network; then Clear and Reset. Nothing resumes by itself."


class StreamSilent(RobotError):
    """The robot no longer reports its ticks."""

    number = 312
    text = "Robot's stream of positions went silent"
    cause = "The job program on the controller hangs, the link is half open, or this PC was too "
    cause += "busy to read what was sent."
    remedy = "Check the job program, and what else loads this PC; then Clear and Reset."


class SetpointRefused(RobotError):
    """The controller refused a streamed setpoint, and stopped."""

    number = 313
    text = "Robot refused a streamed setpoint and stopped"
    cause = "The setpoint lay further away than the stream allows, or out of the robot's reach."
    remedy = "See the controller's reason in the detail; check the limits of the stream."


class ZoneTaken(RobotError):
    """A move needs a zone in which another arm is, or may be; nothing was moved."""

    number = 314
    text = "Robot was not moved: another arm is in the zone that it needs"
    cause = "The other arm stands or moves there, or its robot does not report its place."
    remedy = (
        "Bring the arm that the detail names out of the zone: by Reset and a new start, or with "
        "its panel. Where its place is not known, restore its link first."
    )
    reaction = Reaction.STOP


class WayNotReached(RobotError):
    """A straight move that the arm cannot follow was not sent."""

    number = 318
    text = "Arm cannot follow a straight move to its target"
    cause = (
        "The way leaves the arm's reach or the limits of its joints, or comes through a singular "
        "pose: wrong calibration, recipe or measurement, or the arm is folded otherwise than it "
        "was taught."
    )
    remedy = (
        "See in the detail how far the arm would come. Check calibration and recipe; bring the "
        "arm to a taught pose by its panel, and teach the pose before this move anew if it recurs."
    )


class ArmOffReference(RobotError):
    """Targets on an arm are not where they were when its base frame was measured."""

    number = 319
    text = "Arm is no longer where its base frame was measured"
    cause = (
        "A joint was mastered anew or exchanged, the base of the arm or the large-field head was "
        "moved, or a target on the flange was."
    )
    remedy = "Find what was moved, and measure the base frame and all boards again."
    reaction = Reaction.STOP


class OtherLoadSelected(RobotError):
    """A controller reckons with another load than the cell file states."""

    number = 336
    text = "Controller reckons with another load than the cell file states"
    cause = (
        "Another tool is chosen at the pendant, its load was never entered, or gripper or part are "
        "others than the cell file says."
    )
    remedy = (
        "Choose tool and load at the pendant, or correct `load` of the robot; then Clear and Reset."
    )
    reaction = Reaction.STOP


class ArmReferenceMissing(RobotError):
    """There is nothing to compare an arm with."""

    number = 320
    text = "Arm cannot be compared with its reference"
    cause = "The base frame was measured by an older version or offline, or targets are hidden."
    remedy = "See to it that the targets on the flange are seen, or measure the base frame again."
    reaction = Reaction.STOP
