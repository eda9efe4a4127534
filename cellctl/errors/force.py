"""5xx: force sensor (50x), guard (51x), contact (52x), payload and commissioning (54x)."""

from cellctl.errors.base import CellError, Reaction


class ForceError(CellError):
    """Force sensing or contact left its window; may carry the force curve up to the fault."""

    def __init__(self, detail: str = "", curve: object | None = None) -> None:
        super().__init__(detail)
        self.curve = curve
        """``cellctl.force.contact.curve.ForceCurve`` of the attempt; None when there is none."""


class SensorSilent(ForceError):
    """No sample within the staleness limit."""

    number = 501
    text = "Force sensor has fallen silent"
    cause = "Cable, power or network of the sensor's box, or its data stream stopped."
    remedy = "Check the box and its link; then Clear and Reset. The cell tares again by itself."


class SensorSaturated(ForceError):
    """A channel is at the end of its range."""

    number = 502
    text = "Force sensor is saturated"
    cause = "Load beyond the sensor's range, a damaged gauge, or a loose connector."
    remedy = "Unload the sensor, inspect it for overload, and compare its zero with the sheet."


class SensorDataInvalid(ForceError):
    """Samples arrive but their content cannot be used."""

    number = 503
    text = "Force sensor sends unusable values"
    cause = "Electrical noise, wrong format or firmware of the box, or a broken bridge."
    remedy = "Check shielding and the box's configuration; see the counters in the detail."


class SensorFrozen(ForceError):
    """Samples arrive with new numbers but the same value."""

    number = 504
    text = "Force sensor value is frozen"
    cause = "The box repeats its last conversion: A/D fault or a hung program."
    remedy = "Power-cycle the box; replace it if the fault returns."


class SensorRateWrong(ForceError):
    """The sample rate left its tolerance."""

    number = 505
    text = "Force sensor sends at a wrong rate"
    cause = "Rate setting of the box, network load, or lost samples."
    remedy = "Compare the box's rate setting with the cell file; check the network."


class SensorSetupWrong(ForceError):
    """The box is not configured the way the cell file says."""

    number = 506
    text = "Force sensor box has an unexpected configuration"
    cause = "Another box, a reset to factory settings, or a wrong cell file."
    remedy = "See the setting in the detail; correct the box, then Clear and Reset."
    reaction = Reaction.STOP


class GuardDied(ForceError):
    """The guard process ended or stopped answering."""

    number = 510
    text = "Force guard is not running"
    cause = "The guard process crashed, was killed, or hangs."
    remedy = "Clear, then Reset starts a new one; nothing moves without it. Why it ended is in the "
    remedy += "daemon's journal (`journalctl -u cellctl`; of a demo `daemon.log` in its folder)."


class GuardRefused(ForceError):
    """The guard did not accept a request."""

    number = 511
    text = "Force guard refused a request"
    cause = "No fresh samples, no gravity compensation, a latched trip, or limits out of range."
    remedy = "See the guard's reason in the detail; then Clear and Reset."


class ForceLimitExceeded(ForceError):
    """A compensated force or moment passed its limit: the guard has stopped the robot, or it stood
    already."""

    number = 512
    text = "Force limit exceeded"
    cause = (
        "Contact where none was expected, a wrong payload, a robot that stopped too late, or a "
        "sensor whose axes are not those of the cell file, so that a touch is not felt as one."
    )
    remedy = (
        "Look at the force curve in the record; inspect the parts before the next attempt. If the "
        "force has grown with the wrong sign: push the tool by hand as `cellctl check` says, and "
        "set right `flange_T_sensor`. If the move touched nothing: compare `free_force_n` of the "
        "sensor with the force that its load makes as a move starts (docs/guard.md)."
    )


class FlangePoseStale(ForceError):
    """The flange pose that gravity compensation needs is too old."""

    number = 513
    text = "Flange pose for the force guard is too old"
    cause = "The robot's guard channel stopped sending although its connection stands."
    remedy = "Check the background job on the robot; then Clear and Reset."


class GuardNotRealTime(ForceError):
    """The PC refused the guard a measure against being late."""

    number = 514
    text = "The force guard runs without real-time measures"
    cause = "Missing rights (CAP_SYS_NICE, CAP_IPC_LOCK, limits), a container, or a control group."
    remedy = (
        "Start the daemon as the shipped systemd unit does; docs/guard.md names what each needs."
    )
    reaction = Reaction.WARN


class NotSettled(ForceError):
    """The wrench at the stand-off is not steady enough to tare."""

    number = 520
    text = "Force is not steady at the stand-off"
    cause = "Robot still moving, vibration, swinging hoses, or a disturbed sensor."
    remedy = "Check hoses and surroundings; the detail names the component and its scatter."
    reaction = Reaction.STOP


class TareImplausible(ForceError):
    """The residual wrench before the tare is larger than compensation can leave."""

    number = 521
    text = "Force is implausible before the tare"
    cause = (
        "Payload identification out of date, another part, the part already touches, or another "
        "load than the `load` of the robot's section."
    )
    remedy = "Check that the part hangs free; identify the payload again."
    reaction = Reaction.STOP


class ContactPlanInvalid(ForceError):
    """The plan of a contact contradicts itself, the cell's limits or the robot's position."""

    number = 528
    text = "Contact cannot be planned as asked"
    cause = "Recipe or commissioning figures that do not fit together, or a wrong start pose."
    remedy = "See the contradiction in the detail; correct recipe or commissioning."
    reaction = Reaction.STOP


class LiftOffHeld(ForceError):
    """The force changed too much while the robot left the station with or from a part."""

    number = 529
    text = "Something holds the part while the robot leaves"
    cause = "Part fastened and gripper still shut, a pin that catches, or a hose that pulls."
    remedy = (
        "Look where the part is. Where it sits on its seat: loosen it, or open the gripper. Where "
        "it hangs: keep the gripper shut and free what pulls. Then Clear and Reset."
    )


class PartLeftInPlace(ForceError):
    """An arm that has not left the place of a part, found at the next start."""

    number = 531
    text = "An arm was left in the place of its part"
    cause = (
        "Told at the start of the daemon: it ended after a Stop or a fault in contact, or with a "
        "part that something holds (F529), before the arm had left."
    )
    remedy = (
        "Look at arm and part as told; free a part that is held. Then Reset: with what pulls "
        "already it pulls by the less, and at the whole pull not at all (F529)."
    )
    reaction = Reaction.WARN


class PayloadFileInvalid(ForceError):
    """A file of poses and wrenches cannot be read."""

    number = 540
    text = "File of poses and wrenches is invalid"
    cause = "Missing column, text where a number belongs, or a quaternion that is none."
    remedy = "Correct the line named in the detail; the columns are in docs/mating.md."
    reaction = Reaction.STOP


class TooFewPoses(ForceError):
    """Not enough distinct poses for the unknowns."""

    number = 541
    text = "Too few poses for payload identification"
    cause = "Fewer distinct orientations than the parameters need."
    remedy = "Record more poses; twelve or more around the mating orientation are advised."
    reaction = Reaction.STOP


class PosesDegenerate(ForceError):
    """The poses leave a parameter without excitation."""

    number = 542
    text = "Poses do not excite the payload parameters"
    cause = "Gravity hardly moves in the sensor: turns about the vertical or one tilt axis only."
    remedy = "Tilt about two horizontal axes of the base, 10° to 15° each way."
    reaction = Reaction.STOP


class CommissioningFailed(ForceError):
    """Stop latency or stiffness could not be estimated from the record."""

    number = 544
    text = "Stop latency or stiffness could not be measured"
    cause = "Too few or too similar speeds, or points that do not lie on a line."
    remedy = "Repeat with three or more clearly different speeds."
    reaction = Reaction.STOP
