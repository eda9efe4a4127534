"""486, 56x–58x, 596: planning where a plug goes, and judging how it went in.

PluggingError
├── StaleLook, PlugUncertain, OutOfTaughtRange, CalibrationsDoNotBelongTogether,
│   LooksIncomplete, SocketImplausible,
│   LooksDisagree, PlanFarFromDrawing                                    560–568  the plan
├── PlugEarlyContact, PlugSideForce, PlugShortSeat, PlugOverForce,
│   PlugBentPin, InsertionCurveInvalid                                   570–575  the insertion
├── ModuleMissing, ModuleMisplaced, WrongModuleMass, ModuleInGripper     580–583  the module
├── PlugNotHeld, MovedOnRelease                                          584–585  after the seat
├── ModuleInQuarantine                                                   486      an earlier run
├── GrippedOffTwice                                                      586      the grip
└── SocketUnsound                                                        596      the socket
"""

from cellctl.errors.base import CellError, Reaction


class PluggingError(CellError):
    """A plug may not be moved to its socket, or did not go in as it should."""

    reaction = Reaction.STOP


class StaleLook(PluggingError):
    """A look at plug or socket is too old, or lies in the future."""

    number = 560
    text = "A look at plug or socket is too old"
    cause = "The cell waited between looking and plugging, so drift and slip are not bounded."
    remedy = "Look at plug and socket again, then plan."


class PlugUncertain(PluggingError):
    """The predicted error of the worst contact is beyond the tolerance."""

    number = 561
    text = "The plug's place is too uncertain"
    cause = (
        "The largest term in the detail: repeatability of the robot, a poor image, an uncertain "
        "calibration, or drift."
    )
    remedy = "Look more often, teach more plugs, or use the scheme with gripper marks."


class OutOfTaughtRange(PluggingError):
    """No taught slot is near enough to the socket."""

    number = 562
    text = "The socket is too far from every taught slot"
    cause = "The correction holds near the slots that it was taught at; the arm's error changes."
    remedy = "Teach this slot with `cellctl calibrate plug`."


class CalibrationsDoNotBelongTogether(PluggingError):
    """Calibrations, looks and correction were not made with one another."""

    number = 563
    text = "Calibrations do not belong together"
    cause = (
        "Intrinsics were exchanged after the hand-eye calibration, or the plug correction was "
        "taught with another camera, gripper, connector or scheme."
    )
    remedy = "Calibrate hand-eye with the intrinsics in use, then teach the plug correction again."


class LooksIncomplete(PluggingError):
    """The scheme needs a look or a measurement that is not there."""

    number = 565
    text = "A look that the scheme needs is missing"
    cause = "No look at plug or socket, no gripper marks in the image, or no reference plate."
    remedy = "Take the look in the detail, or choose a scheme that does without it."


class SocketImplausible(PluggingError):
    """Two looks at one socket disagree."""

    number = 566
    text = "Looks at the socket contradict each other"
    cause = "The panel moved between looks, or another socket was measured."
    remedy = "Check that the panel is fixed; look again."


class LooksDisagree(PluggingError):
    """Images of a scene that should stand still differ by more than their noise."""

    number = 567
    text = "Images of one look contradict each other"
    cause = "The arm, the panel or the camera swung or was touched while the images were taken."
    remedy = "Find what moves: hoses, fixture, floor; then start again."


class PlanFarFromDrawing(PluggingError):
    """The planned pose of the flange is not near where the drawing has it."""

    number = 568
    text = "Planned pose is far from the drawing"
    cause = "A taught correction of another cell, a wrong drawing, or a wrong place in the recipe."
    remedy = "Compare the poses in the detail with the recipe; teach the plug again."


class PlugEarlyContact(PluggingError):
    """Axial force before the contact springs begin."""

    number = 570
    text = "Plug touched too early"
    cause = "A bent pin, an offset, a turned module, or a foreign body on the socket."
    remedy = "Put the module into quarantine; inspect its pins and the socket."


class PlugSideForce(PluggingError):
    """Side force or moment beyond what an aligned plug shows."""

    number = 571
    text = "Side force while plugging"
    cause = "An offset or a turn beyond the play of the contacts, or a bent pin."
    remedy = "Put the module into quarantine; inspect its pins and the socket."


class PlugShortSeat(PluggingError):
    """The seat was felt at another depth than the drawing says, or not at all."""

    number = 572
    text = "Plug is not seated at its depth"
    cause = (
        "A foreign body, a shell that catches, or a socket at another height. Where no seat was "
        "felt also forces that are too small or have the other sign: a sensor with another unit, "
        "scale or `flange_T_sensor`."
    )
    remedy = (
        "Put the module into quarantine; inspect socket and shell. Compare the greatest force in "
        "the detail with that of other plugs."
    )


class PlugOverForce(PluggingError):
    """The axial force is beyond what the contacts may take."""

    number = 573
    text = "Insertion force beyond its limit"
    cause = "Pins stand on the socket's face, or a lot of contacts that are too tight."
    remedy = "Put the module into quarantine; inspect its pins and the socket."


class PlugBentPin(PluggingError):
    """Force and moment before the springs point at one contact."""

    number = 574
    text = "A contact met the socket's face"
    cause = "A pin that is bent; the detail names the contact that the moment points at."
    remedy = (
        "Put the module into quarantine; inspect the contact in the detail, of the socket and, with"
        " the same name, of the plug."
    )


class InsertionCurveInvalid(PluggingError):
    """A file with an insertion curve cannot be used."""

    number = 575
    text = "Insertion curve cannot be judged"
    cause = (
        "Missing columns, text where numbers belong, time that runs back, too few samples, or "
        "numbers that no insertion can have in their unit, sign or axes."
    )
    remedy = "See the line or column in the detail; the columns are in docs/plugging.md."


class ModuleMissing(PluggingError):
    """Camera I does not see the top of a module on its tray."""

    number = 580
    text = "No module on the tray"
    cause = "Tray empty or not in its place, module upside down, or lamp off."
    remedy = "Lay a module onto the tray, its plug down; look at the picture."


class ModuleMisplaced(PluggingError):
    """A module lies on its tray, but not as it should."""

    number = 581
    text = "Module lies wrong on its tray"
    cause = "Turned, mirrored, which is another type, or out of its pocket."
    remedy = "Lay the module into its pocket as the drawing shows; check its type."


class WrongModuleMass(PluggingError):
    """What the gripper lifted weighs something else than the module."""

    number = 582
    text = "The gripped module has the wrong mass"
    cause = "Another type, a module that caught on its tray, or one that hangs on something."
    remedy = "Take the module out of the gripper by hand, weigh it, check its type."


class ModuleInGripper(PluggingError):
    """Something is between the jaws where they should be empty."""

    number = 583
    text = "There is a module in the gripper"
    cause = "A run ended with the module held: after a fault, a stop or a restart."
    remedy = "Take it out by hand and put it into quarantine, then Reset. Nothing resumes with it."


class PlugNotHeld(PluggingError):
    """The plug followed the pull before it resisted."""

    number = 584
    text = "Plug is not held by its socket"
    cause = "Not seated, contacts without spring force, or a latch that did not catch."
    remedy = "Put the module into quarantine; inspect contacts and socket."


class MovedOnRelease(PluggingError):
    """The module is not where it was when the gripper held it."""

    number = 585
    text = "Module moved when it was released"
    cause = "Strain between gripper and socket, a finger that clings, or a plug that came out."
    remedy = "Put the module into quarantine; check the jaws; teach the plug again."


class GrippedOffTwice(PluggingError):
    """The plug is beyond the range of the grip, also after it was put back and gripped again."""

    number = 586
    text = "Module was gripped off its place twice"
    cause = "A connector off on its housing, worn or dirty jaws, or a moved camera I."
    remedy = "Take the module out by hand and put it into quarantine; check jaws and tray."


class SocketUnsound(PluggingError):
    """A hole of the socket is blocked, missing, bent or hidden; the module has met nothing."""

    number = 596
    text = "A hole of the socket is not as it should be"
    cause = "Something in the hole, a damaged insulator, or dirt on the face."
    remedy = "Look at the picture; clean or exchange the socket, and take the module out by hand."


class ModuleInQuarantine(PluggingError):
    """A module of this serial number has met a force fault in an earlier run, or was left in its
    insertion."""

    number = 486
    text = "This module belongs into quarantine"
    cause = (
        "An earlier run of this serial number, in the detail, ended with a force fault, or within "
        "its insertion before the force was judged, as by an Abort: its pins may be bent, and a "
        "second insertion could damage the socket, too."
    )
    remedy = (
        "Keep the module in quarantine. One that was inspected and repaired begins anew with a "
        "serial number of its own, such as the old one with R1 behind it."
    )


FORCE_FAULTS: frozenset[type[PluggingError]] = frozenset(
    {PlugEarlyContact, PlugSideForce, PlugShortSeat, PlugOverForce, PlugBentPin, PlugNotHeld}
)
"""What a module must not be plugged again after."""
