"""Holds the pin holes of a deck against the dowels that there are, and the screws beside them.

Those of the frame are held against the deck's. A slip that is in both drawings shows here alone.
"""

from collections.abc import Iterator
from statistics import median

from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.checks.plausible.drawing import PartDrawing

_DOWELS_MM = (
    1.0,
    1.5,
    2.0,
    2.5,
    3.0,
    4.0,
    5.0,
    6.0,
    8.0,
    10.0,
    12.0,
    16.0,
    20.0,
    25.0,
    30.0,
    40.0,
    50.0,
)
"""Diameters of ISO 8734 and ISO 2338 that are in use."""
_TIGHTER_MM, _WIDER_MM = 0.05, 0.2
"""How much narrower than a dowel its hole may be where it is pressed in, and how much wider where
it has play."""
_OVER_SCREWS = (0.7, 2.0)
"""Diameter of a pin over that of the screws beside it. Pins that relieve screws of shear are as
thick as these or a size thicker; M4 with 3 mm and M5 with 8 mm are what is met at the ends."""


def pin_size_remarks(deck: PartDrawing, frame: PartDrawing) -> Iterator[ConfigIssue]:
    """A remark for the first pin hole that is odd, by either comparison."""
    odd = [*_dowels(deck), *_beside_screws(deck, frame)]
    yield from odd[:1]


def _dowels(deck: PartDrawing) -> Iterator[ConfigIssue]:
    """A pin hole for which there is no pin; that of the frame is held against it."""
    for hole in deck.features.holes:
        wide_mm = hole.diameter_m / MM
        if hole.kind != "pin":
            continue
        if not any(-_TIGHTER_MM <= wide_mm - dowel_mm <= _WIDER_MM for dowel_mm in _DOWELS_MM):
            below = [f"{one:g}" for one in _DOWELS_MM if one < wide_mm][-1:]
            above = [f"{one:g}" for one in _DOWELS_MM if one > wide_mm][:1]
            said = (
                f"no dowel has this diameter (ISO 8734: {' or '.join(below + above)}); right if "
                "the pin is a special one"
            )
            yield deck.hole_issue(hole.name, "diameter_mm", f"{wide_mm:g}", said)
            return


def _beside_screws(deck: PartDrawing, frame: PartDrawing) -> Iterator[ConfigIssue]:
    """Pins that are far thinner or thicker than the screws of the same joint."""
    threads_mm = [hole.diameter_m / MM for hole in frame.features.holes if hole.kind == "thread"]
    if not threads_mm:
        return
    screw_mm = median(threads_mm)
    for hole in deck.features.holes:
        wide_mm = hole.diameter_m / MM
        if hole.kind != "pin" or _OVER_SCREWS[0] <= wide_mm / screw_mm <= _OVER_SCREWS[1]:
            continue
        said = (
            f"the screws beside it have {screw_mm:g} mm ({frame.written}), and pins usually are "
            f"{_OVER_SCREWS[0]:g} to {_OVER_SCREWS[1]:g} times as thick: is it the radius, in both "
            "files? Right if the joint has such pins"
        )
        yield deck.hole_issue(hole.name, "diameter_mm", f"{wide_mm:g}", said)
        return
