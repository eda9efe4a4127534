"""Holds the two drawings of the reference plate against each other: the same dots, in a mirror."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM, Array
from cellctl.processes.antenna_module.connector.marks import Marks
from cellctl.processes.antenna_module.drawings import read_plate
from cellctl.processes.antenna_module.settings import ReferenceSection

_WIDER = 0.1
"""Relative difference of two diameters; a print that is seen through glass differs by less."""
_APART_M = 0.05e-3
"""Two drawings of one dot have it at one place; one that was measured from both sides differs by
less."""


def plate_side_remarks(
    reference: ReferenceSection, where: str, folder: Path
) -> Iterator[ConfigIssue]:
    """Dots that are of other sizes or at other places from below; ``where`` is the key of the
    settings of the process."""
    plate = read_plate(reference, folder)
    said = _differs(plate.above, plate.below)
    if said is not None:
        said = f"{said}; right if other dots are seen from below than from above"
        yield ConfigIssue(f"{where}.reference.plate_below", repr(reference.plate_below), said)


def _differs(above: Marks, below: Marks) -> str | None:
    if set(above.names) != set(below.names):
        return (
            f"plate_above has the dots {', '.join(above.names)}, this one {', '.join(below.names)}"
        )
    if abs(below.diameter_m / above.diameter_m - 1.0) > _WIDER:
        return (
            f"plate_above has diameter_mm = {above.diameter_m / MM:g}, this one "
            f"{below.diameter_m / MM:g}, and both are of the same dots, as one that is a radius"
        )
    order = [below.names.index(name) for name in above.names]
    off_m = np.abs(_apart_m(above.positions_m) - _apart_m(below.positions_m[order]))
    if off_m.max() > _APART_M:
        one, other = (above.names[int(at)] for at in np.unravel_index(off_m.argmax(), off_m.shape))
        return (
            f"by it {one} and {other} are {off_m.max() / MM:.2f} mm nearer to each other or "
            "farther apart than by plate_above"
        )
    return None


def _apart_m(positions_m: Array) -> Array:
    """Distances of all pairs, shape (n, n): whatever way the mirror lies."""
    return np.asarray(np.linalg.norm(positions_m[:, None] - positions_m[None], axis=2))
