"""54x–55x and 59x: finding a hole by touch, and judging what went into it; 337: arm or panel moved.

ByTouchError
├── SearchImpossible, HeightTooNoisy                545–546  refused before any contact
├── HoleAbsent, SearchGaveUp                        547–548  the search
├── WrongFeature                                    598      what the peg stands in
├── FaceAbsent, FaceUneven, FaceTilted              549–551  the face
├── PanelOffReference                               337      the face against its reference
├── PegJammed, PegWedged, HoleBlocked               552–554  the insertion
└── PegNotInserted
    ├── SensorDead, PegSlipped, NotSeated, FalseSeat,
    │   HoleTooWide, PegNotHeld                     590–595  the verdict
    └── ForceActsWithFeed, ForceDropped             599, 557  feed and verdict
"""

from typing import ClassVar

from cellctl.errors.base import CellError, Reaction


class ByTouchError(CellError):
    """A hole may not be searched by touch, was not found, or the peg did not go in."""

    reaction = Reaction.STOP
    leaves_hole: ClassVar[bool] = True
    """Whether the peg is drawn out after it; False where a pull could do harm, or nobody would feel
    it."""


class SearchImpossible(ByTouchError):
    """No strategy finds this hole in the time that it is given."""

    number = 545
    text = "No search by touch fits this hole and this cell"
    cause = "Stiffness times dead time of the cell is too great for so tight a hole."
    remedy = (
        "Put a compliance of at most 2e5 N/m at the wrist, shorten the dead time of the stream, or "
        "locate the hole better."
    )


class HeightTooNoisy(ByTouchError):
    """A tilted touch could not tell a hole from the noise of the height."""

    number = 546
    text = "Heights in contact are too uncertain for tilted touches"
    cause = "Noise of force or position makes the height of a touch uncertain."
    remedy = "Average longer, press harder, or use a strategy without tilted touches."


class HoleAbsent(ByTouchError):
    """The whole map was searched and holds no hole."""

    number = 547
    text = "There is no hole where one was expected"
    cause = "Wrong part, wrong place, a closed hole, or an uncertainty that is stated too small."
    remedy = "Look at the part; compare its place with what vision reported."


class SearchGaveUp(ByTouchError):
    """A search came to its time limit."""

    number = 548
    text = "The hole was not found in time"
    cause = "The place was more uncertain than stated, or touches were not recognised."
    remedy = "Look at the search path in the report; locate the part again."


class WrongFeature(ByTouchError):
    """What the peg stands in is no round hole of its size."""

    number = 598
    text = "The peg stands in something that is not its hole"
    cause = "A slot, a gap between two parts, a much wider hole, or the place beside a plug."
    remedy = "Look at the part at the place in the detail; locate the hole better."


class FaceAbsent(ByTouchError):
    """No face was touched where vision reports one."""

    number = 549
    text = "The face of the hole was not met"
    cause = (
        "The part is missing or elsewhere, its height is more uncertain than stated, or the axes "
        "of the force sensor are not those of the cell file."
    )
    remedy = (
        "Look at the part; compare its place with what vision reported. If the part was pressed: "
        "push the tool by hand as `cellctl check` says, and set right `flange_T_sensor`."
    )


class FaceUneven(ByTouchError):
    """Four touches do not lie in a plane."""

    number = 550
    text = "The face of the hole is not even"
    cause = "A chip or burr under one touch, a touch beside the face, or a part that gives way."
    remedy = "Clean the face; choose a radius of the touches that stays on it."


class FaceTilted(ByTouchError):
    """The face stands at another angle than vision reports."""

    number = 551
    text = "The face is tilted more than vision may be wrong"
    cause = "The part lies askew, or its orientation was measured wrong."
    remedy = "Locate the part again; check how it is fixed."


class PanelOffReference(ByTouchError):
    """The arm meets the face elsewhere than when its reference was taken."""

    number = 337
    text = "Arm or panel is no longer where the panel's reference was taken"
    cause = (
        "The base of the arm or the panel was moved, a joint was mastered anew or exchanged, or "
        "tool or part sit otherwise in the gripper."
    )
    remedy = (
        "Find what was moved. Teach the poses before the hole anew if it was the arm, then run "
        "procedure 302 and 301."
    )


class PegJammed(ByTouchError):
    """The peg stands short of its seat, and nothing has helped."""

    number = 552
    text = "The peg is jammed in its hole"
    cause = "The axes of peg and hole stand at an angle, or friction is greater than stated."
    remedy = "Compare grip and face in the report; clean both parts; check the angle of the grip."


class PegWedged(ByTouchError):
    """Side force and moment stay although nothing pushes any more."""

    number = 553
    text = "The peg is wedged in its hole"
    cause = "It entered at too great an angle; after an aligned entry something else is wrong."
    remedy = "Free the part by hand; do not let the robot pull harder. Look for damage."
    leaves_hole = False


class HoleBlocked(ByTouchError):
    """A straight peg meets the same resistance twice at the same depth."""

    number = 554
    text = "The hole is blocked or too shallow"
    cause = "A foreign body, the wrong part, or another depth than the drawing has."
    remedy = "Look into the hole; compare part and recipe."


class KeywayNotFound(ByTouchError):
    """The plug stands on the ends of its keyway at every angle that was tried."""

    number = 555
    text = "The keys of the plug found no keyway"
    cause = "Another keying than the socket's, or the part is turned farther than the recipe says."
    remedy = "Compare keying and angle of plug and socket; look for a bent or broken key."


class PegCurveInvalid(ByTouchError):
    """A file of a recorded insertion that cannot be judged."""

    number = 556
    text = "The recorded insertion cannot be judged"
    cause = "Another file, missing columns, unknown units, or signs that contradict the motion."
    remedy = "Compare the file with the columns in docs/insertion-by-touch.md."


class PegNotInserted(ByTouchError):
    """A peg that is not known to be inserted. Subclasses say which evidence is missing."""


class SensorDead(PegNotInserted):
    """The force did not change while the peg was pushed."""

    number = 590
    text = "The force sensor did not feel the peg being pushed"
    cause = "The sensor repeats an old value, its cable is loose, or nothing holds the peg."
    remedy = "Do not pull the peg out by the robot before the sensor answers; check the sensor."
    leaves_hole = False


class PegSlipped(PegNotInserted):
    """The part may have slipped in the gripper, so depths mean nothing."""

    number = 591
    text = "The part has slipped in the gripper, or nobody can tell"
    cause = (
        "A force above 60 % of the grip force, a face that carried the part while the arm went on, "
        "a force that stayed before the seat while the arm went on, or a rear that is not where "
        "the drawing has it."
    )
    remedy = (
        "Take the part out by hand; check jaws and grip pressure; measure the grip force. If the "
        "part has contacts that hold it back before its seat, state them as fit.contacts."
    )
    leaves_hole = False


class NotSeated(PegNotInserted):
    """Depth or force at the end is not that of the seat."""

    number = 592
    text = "The peg is not at its seat"
    cause = "A blocked or wrong hole, a jam, or a face whose height was not touched right."
    remedy = "Look at the forces over depth in the report; look into the hole."


class FalseSeat(PegNotInserted):
    """The depth is right, but the peg gives way sideways."""

    number = 593
    text = "The peg gives way sideways: it stands beside the hole or on its edge"
    cause = "The part has slipped in the gripper while it stood on the face or on a chamfer."
    remedy = "Take the part out by hand and look at both; grip it again."


class HoleTooWide(PegNotInserted):
    """More play than the drawing has."""

    number = 594
    text = "The peg has too much play: this is another hole"
    cause = "A neighbouring hole, a hole of another size, or the wrong part."
    remedy = "Compare part and place with the recipe; locate the hole better if others are near."


class PegNotHeld(PegNotInserted):
    """Key or lock does not hold."""

    number = 595
    text = "The part can be turned or pulled out"
    cause = "The key has not engaged, or the lock of the connector is open."
    remedy = "Plug the part by hand and compare; check keys and lock."


class ForceActsWithFeed(PegNotInserted):
    """The sensor shows that the hole pulls the part in, which no hole does."""

    number = 599
    text = "The force acts with the feed instead of against it"
    cause = "The zero of the force sensor has moved since the tare, or an axis has another sign."
    remedy = (
        "The part was pushed harder than the sensor shows: take it out by hand and look at it. "
        "Check cable and mounting of the sensor, and its zero with nothing touching."
    )
    leaves_hole = False


class ForceDropped(PegNotInserted):
    """The force fell at once while the tip did not go back: the zero of the sensor has jumped."""

    number = 557
    text = "The force dropped while the part was pushed on"
    cause = (
        "The zero of the force sensor has jumped, or something has given way: a contact or a lock "
        "that snapped in, a part that broke."
    )
    remedy = (
        "The part may have been pushed harder than the sensor shows: take it out by hand and look "
        "at it. Check cable and mounting of the sensor, and its zero with nothing touching."
    )
    leaves_hole = False
