"""54x–55x and 59x: finding a hole by touch, and judging what went into it.

ByTouchError
├── SearchImpossible, HeightTooNoisy                545–546  refused before any contact
├── HoleAbsent, SearchGaveUp                        547–548  the search
└── PegNotInserted and its signatures               590–597  the insertion
"""

from cellctl.errors.base import CellError, Reaction


class ByTouchError(CellError):
    """A hole may not be searched by touch, was not found, or the peg did not go in."""

    reaction = Reaction.STOP


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
