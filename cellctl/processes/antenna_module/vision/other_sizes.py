"""Looks for a pattern of another size where none of the drawn one is found, to say so."""

from cellctl.geometry.pose import MM
from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.antenna_module.faults.connector import MarksMissing
from cellctl.processes.antenna_module.vision.pattern import Candidates, Pattern, find_pattern
from cellctl.processes.antenna_module.vision.plane import MeasuringPlane

_OTHER_SIZES = (2.0, 0.5)
"""Diameters over the drawn one: a radius in place of a diameter, and the reverse."""


def spots_of_another_size(
    image: Image, plane: MeasuringPlane, pattern: Pattern, least: int, *, chiral: bool = False
) -> str | None:
    """Words for what is there in another size and in the drawn arrangement, or at least in the
    drawn number; None where nothing is.

    ``chiral``: only an arrangement counts, as the few marks of a gripper are soon outnumbered by
    what else has their size.
    """
    for size in _OTHER_SIZES:
        other = pattern.with_diameter(size * pattern.diameter_m)
        found = find_pattern(image, plane, other, least=least, chiral=chiral)
        if len(found.spots.px) >= least and (found.placements or not chiral):
            return f"{len(found.spots.px)} spots of {other.diameter_m / MM:.2f} mm diameter"
    return None


def missing_marks(
    image: Image, plane: MeasuringPlane, pattern: Pattern, candidates: Candidates, least: int
) -> MarksMissing:
    """The fault for a picture in which fewer than ``least`` marks of ``pattern`` are good."""
    other = spots_of_another_size(image, plane, pattern, least, chiral=True)
    if other is not None:
        return MarksMissing(
            f"{other} lie as the marks of {pattern.diameter_m / MM:.2f} mm are drawn: is "
            "diameter_mm the radius, or twice the diameter?"
        )
    if candidates.placements or candidates.mirrored:
        return MarksMissing("too few marks are clean and in their places")
    return MarksMissing(f"{len(candidates.spots.px)} spots, {least} marks needed")
