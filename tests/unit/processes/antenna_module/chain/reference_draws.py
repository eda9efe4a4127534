"""Looks at marks and plate as an arm that repeats to RP 0.02 mm would have them."""

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.chain.cell_figures import ArmFigures
from cellctl.processes.antenna_module.chain.reference.reference_looks import (
    ReferenceLooks,
    turn_angles,
)
from cellctl.processes.antenna_module.chain.teaching.tool_turn import TurnStop

ARM = ArmFigures(5.53e-6, 1.745e-5, 0.26e-3, 24e-6)
LEVER_M = 0.24
IMAGE_M = 0.4e-6
"""Standard deviation of one look; marks are the larger ones."""
OFFSET_M = np.array([0.11e-3, -0.17e-3])
"""Marks beside the axis."""
NONE = np.zeros(2)


def drawn_looks(
    count: int,
    rng: np.random.Generator,
    *,
    axis: Array = NONE,
    marks: Array = NONE,
    plate_1: Array = NONE,
    plate_2: Array = NONE,
) -> ReferenceLooks:
    """Looks whose places are off the taught ones by these, x and y in m."""
    one_m = float(np.hypot(ARM.repeatability_m, ARM.repeatability_rad * LEVER_M))
    stops = []
    for angle in turn_angles(count):
        c, s = np.cos(angle), np.sin(angle)
        seen = axis + np.array([[c, -s], [s, c]]) @ (OFFSET_M + marks)
        stops.append(TurnStop(angle, seen + rng.normal(0, one_m, 2) + rng.normal(0, IMAGE_M, 2)))
    return ReferenceLooks(
        tuple(stops),
        tuple(plate_1 + rng.normal(0, one_m, 2) for _ in range(count)),
        (plate_2 + rng.normal(0, IMAGE_M, 2),),
        LEVER_M,
    )
