"""576–579, 587–589 and 338: contact under a stream of setpoints.

StreamedContactError
├── LoopNotMeasured, LoopTooSlow, LoopUnstable      576–578  refused before any contact
├── LoopFitRefused                                  579      commissioning
├── ContactLost, AdmittanceSaturated                587–588  the contact
├── StreamLate                                      589      the ticks
└── HeldTooLong                                     338      work beside a stream that stands
"""

from cellctl.errors.base import CellError, Reaction


class StreamedContactError(CellError):
    """A stream of setpoints cannot, or can no longer, hold a contact."""


class LoopNotMeasured(StreamedContactError):
    """Stiffness or dead time of the loop is not known."""

    number = 576
    text = "Stiffness or dead time of the contact loop is not known"
    cause = "The cell was never commissioned for streamed contact, or its record is damaged."
    remedy = "Commission the streamed contact with the tool that is mounted."
    reaction = Reaction.STOP


class LoopTooSlow(StreamedContactError):
    """The loop is stable only at gains that are too slow to work with."""

    number = 577
    text = "The contact loop is too slow for this task"
    cause = "Stiffness times dead time of the cell is too great."
    remedy = "Put a compliance of at most 2e5 N/m at the wrist, or shorten the dead time."
    reaction = Reaction.STOP


class LoopUnstable(StreamedContactError):
    """The gains leave no margin of stability, or could pass the force limit."""

    number = 578
    text = "The contact loop would not be stable with these gains"
    cause = "Gains were computed for a softer contact, a shorter dead time or another tip."
    remedy = "Commission the streamed contact again; check the pose of the tip on the flange."
    reaction = Reaction.STOP


class LoopFitRefused(StreamedContactError):
    """What was identified does not explain how the loop behaves."""

    number = 579
    text = "Commissioning of the streamed contact failed"
    cause = "Loose fixture or tool, a lost tick, or a stiffness that changes with the force."
    remedy = "Check fixture, tool and load of the PC; repeat the procedure."
    reaction = Reaction.STOP


class ContactLost(StreamedContactError):
    """A held contact went away."""

    number = 587
    text = "The contact was lost"
    cause = "The part moved, slipped or fell, or the peg slid over an edge."
    remedy = "Look at part and peg; then Clear and Reset."


class AdmittanceSaturated(StreamedContactError):
    """Two axes have given way as far as they may."""

    number = 588
    text = "The arm has given way as far as it may"
    cause = "Part or tool stand further off than expected, or the force sensor has an offset."
    remedy = "Look at the offset in the report; locate the part again; check the tare."


class StreamLate(StreamedContactError):
    """Ticks of the stream or samples of the force came too late to control a contact."""

    number = 589
    text = "Ticks or forces came too late to hold the contact"
    cause = "This PC was too busy, or a network to robot or sensor was interrupted."
    remedy = "Look at load and networks; then Clear and Reset. Nothing resumes by itself."


class HeldTooLong(StreamedContactError):
    """What was to be done while the arm stood in its stream did not end."""

    number = 338
    text = "Work beside a standing stream did not end in time"
    cause = "The disk of the records or a guard hangs, or this PC has no processor left."
    remedy = "Check load and disk of the PC; take the part out by hand, then Clear and Reset."
