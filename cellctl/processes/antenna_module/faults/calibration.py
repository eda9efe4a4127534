"""64x: the calibrations of plugging by two cameras.

CalibrationError
├── TeachScatter, TooFewTeachings                                     641 642  plug correction
├── TurnInvalid                                                       643      turning a tool
└── ReferenceMoved                                                    644      reference check
    ├── FixedCameraMoved, FlangeCameraMoved, GripperMarksMoved,
    └── ReferencePlateMoved, ArmMoved                                 645–649
NobodyPlugged, NobodyTouched                                          650 651  at the panel
"""

from cellctl.errors.calibration import CalibrationError


class TeachScatter(CalibrationError):
    """Taught plugs of one slot disagree."""

    number = 641
    text = "Taught plugs scatter too much"
    cause = "Play in the gauge, a module that slipped, or a robot that repeats badly."
    remedy = "Teach again with a gauge; see the scatter and the worst plug in the detail."


class TooFewTeachings(CalibrationError):
    """Fewer taught plugs than a mean needs."""

    number = 642
    text = "Too few taught plugs"
    cause = "The mean of fewer carries the chance of single plugs into every later one."
    remedy = "Teach at least as many plugs at each slot as the detail says."


class TurnInvalid(CalibrationError):
    """Turning about the flange axis gave no usable circle."""

    number = 643
    text = "Turn about the flange axis cannot be used"
    cause = "Too few angles, angles on one side, the flange moved sideways, or a feature mixed up."
    remedy = "Turn the last joint alone, over at least half a turn, in steps of equal size."


class ReferenceMoved(CalibrationError):
    """The reference check differs from the taught one, and no single device explains it."""

    number = 644
    text = "Cell has moved since it was taught"
    cause = "Several devices moved, or the cell's temperature changed much."
    remedy = "Check what is loose; calibrate hand-eye and teach the plug correction again."


class FixedCameraMoved(ReferenceMoved):
    """Camera II has moved against robot and plate."""

    number = 645
    text = "The fixed camera has moved"
    cause = "A loose bracket, a knock, or warming up."
    remedy = (
        "Fasten it; calibrate it against the robot again; then teach the reference and the plug "
        "correction again."
    )


class FlangeCameraMoved(ReferenceMoved):
    """Camera I has moved against the flange."""

    number = 646
    text = "The camera on the flange has moved"
    cause = "A loose bracket, a knock, or a cable that pulls."
    remedy = "Fasten it; calibrate hand-eye and teach the plug correction again."


class GripperMarksMoved(ReferenceMoved):
    """The marks on the gripper have moved against the flange axis."""

    number = 647
    text = "The gripper marks have moved"
    cause = "A collision of the gripper, a changed finger, or a loose flange adapter."
    remedy = "Inspect the gripper; teach the plug correction again."


class ReferencePlateMoved(ReferenceMoved):
    """The reference plate has moved against camera II and robot."""

    number = 648
    text = "The reference plate has moved"
    cause = "Somebody touched or cleaned it, or its fastening is loose."
    remedy = "Fasten it; teach the reference again."


class ArmMoved(ReferenceMoved):
    """The robot reaches other places than before, seen by both cameras."""

    number = 649
    text = "The robot reaches other places than when it was taught"
    cause = "A collision, a lost joint reference, or warming up."
    remedy = "Let it warm up; if it stays, check the joint references and calibrate again."


class NobodyPlugged(CalibrationError):
    """The arm waited above the socket, and nobody plugged the module by hand."""

    number = 650
    text = "No plug was put in by hand"
    cause = "Nobody turned the key at the panel and jogged the plug into its socket in time."
    remedy = "Take the module out of the gripper, Reset, and start the teaching again."


class NobodyTouched(CalibrationError):
    """The arm waited for a touch of the tool's tip, and nobody jogged it."""

    number = 651
    text = "The tip was not brought to its point"
    cause = "Nobody turned the key at the panel, jogged the tip to its point and turned it back."
    remedy = "Reset, and start the calibration of the tool again with somebody at the panel."
