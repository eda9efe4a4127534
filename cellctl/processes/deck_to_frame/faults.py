"""The faults of a deck on its frame: 43x–45x its pose, 52x its mating.

VisionError
├── UncertaintyTooLarge                                        432      one measurement
├── NoProgress, CorrectionDiverging, CorrectionImplausible,
│   CorrectionLimitReached                                     441–444  pose correction
└── PartMisplaced, SeatedOffPosition                           451 452  where a part is
DeckInGripper                                                  530      before a procedure
MatingFault
└── ContactEarly, ContactLate, DeckNotSeated, LateralLoad,
    CreepNotConverged, MatingOverforce                         522–527  contact
"""

from cellctl.errors.base import Reaction
from cellctl.errors.force import ForceError
from cellctl.errors.vision import VisionError


class UncertaintyTooLarge(VisionError):
    """The permitted number of frames does not bring the uncertainty below its limit."""

    number = 432
    text = "Measurement is too uncertain for its threshold"
    cause = "Noise, blur, weak contrast, or an uncertain calibration between the heads."
    remedy = "Improve the light, allow more frames, or calibrate the heads again."


class NoProgress(VisionError):
    """The error stopped shrinking before it was within its threshold."""

    number = 441
    text = "Pose correction makes no progress"
    cause = "Robot does not resolve the step, friction, or an obstacle."
    remedy = "Compare commanded and reported flange poses of the last iterations."


class CorrectionDiverging(VisionError):
    """The error grew after a correction."""

    number = 442
    text = "Pose correction makes the error grow"
    cause = "Wrong calibration between head and robot, a slipped deck, or a moved head."
    remedy = "Check the grip and the base-to-head calibration before another run."


class CorrectionImplausible(VisionError):
    """A single correction exceeds what can be needed here."""

    number = 443
    text = "A correction is implausibly large"
    cause = "A wrong measurement, a slipped deck, or a moved head."
    remedy = "Look at the pictures of the last two measurements."


class CorrectionLimitReached(VisionError):
    """The permitted number of corrections was used up."""

    number = 444
    text = "Too many corrections without reaching the threshold"
    cause = "Robot repeatability or measurement noise near the size of the threshold."
    remedy = "See the error by iteration in the report; check robot and calibration."


class PartMisplaced(VisionError):
    """A part was measured far from where the recipe puts it."""

    number = 451
    text = "A part is not where it should be"
    cause = "Frame set down wrongly, deck gripped wrongly, wrong recipe, or a wrong calibration."
    remedy = "Look at the picture; set the part down again or check the recipe."
    reaction = Reaction.STOP


class SeatedOffPosition(VisionError):
    """The mated deck is not where it should be."""

    number = 452
    text = "The seated deck is off its position"
    cause = (
        "The deck slipped while it was pressed, something lies between deck and frame, the last "
        "measurement was wrong, or it is too uncertain to prove a seat that close to its limit."
    )
    remedy = (
        "Check the pin holes with plug gauges and the joint with feeler gauges; do not fasten "
        "before the cause is known."
    )
    reaction = Reaction.STOP


class DeckInGripper(ForceError):
    """The sensor carries the deck in a procedure that swings through its space."""

    number = 530
    text = "The deck is still in the gripper"
    cause = "It was not taken out before a procedure whose moves need its space."
    remedy = (
        "Take it out, a heavy one with lifting gear. If the gripper is empty, the deck weighs less "
        "than `max_untared_force_n` of its recipe: write about 4 % of the weight that hangs on the "
        "sensor there, if that is less than the deck weighs, and start cellctl anew. If it is not, "
        "nothing tells the deck: look that the gripper is empty, invalidate the payload "
        '(`cellctl calibrate invalidate payload --reason "empty gripper"`) and identify it again '
        "after."
    )
    reaction = Reaction.STOP


class MatingFault(ForceError):
    """A fault that the mating step itself raises."""


class ContactEarly(MatingFault):
    """Touch before the contact window opened."""

    number = 522
    text = "Contact came too early"
    cause = "Something between deck and frame, a pin that catches, or a wrong measurement."
    remedy = "Inspect the gap between deck and frame; measure both again."
    reaction = Reaction.STOP


class ContactLate(MatingFault):
    """No touch although the contact window has been passed."""

    number = 523
    text = "Contact did not come where it was expected"
    cause = "Wrong measurement or deck thickness, a shifted frame, or a force signal that is dead."
    remedy = "Measure both parts again; check that the force sensor answers a push by hand."
    reaction = Reaction.STOP


class DeckNotSeated(MatingFault):
    """Force without seat depth, in every attempt."""

    number = 524
    text = "Deck does not seat"
    cause = "A pin sits on its chamfer, dirt, or a burr: force is reached above the seat."
    remedy = "Inspect pins, holes and mating faces; then start the run again."
    reaction = Reaction.STOP


class LateralLoad(MatingFault):
    """Force or moment across the mating direction beyond its bound at the seat."""

    number = 525
    text = "Side load too high while mating"
    cause = "Pins or edges catch on one side, or the deck is tilted."
    remedy = "See components in the detail; measure both parts again."
    reaction = Reaction.STOP


class CreepNotConverged(MatingFault):
    """The target force was not reached within the steps or the travel allowed."""

    number = 526
    text = "Target force was not reached"
    cause = "Contact softer than the plan allows, slipping fixture, or a drifting sensor."
    remedy = "See force and travel of the steps in the record; check fixture and sensor."
    reaction = Reaction.STOP


class MatingOverforce(MatingFault):
    """The force along the mating direction reached its abort limit."""

    number = 527
    text = "Mating force reached its abort limit"
    cause = "Contact stiffer or stop slower than measured at commissioning."
    remedy = "Inspect the parts; measure stop latency and stiffness again before the next run."
