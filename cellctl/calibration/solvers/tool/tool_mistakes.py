"""Which mistake explains touches that do not meet in one point, or a tool that points backwards."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.solvers.tool.tool import (
    TIP_FROM_FLANGE,
    Z_FORWARDS,
    ToolResult,
    calibrate_tool,
)
from cellctl.calibration.unit_slips import meant_in_radians
from cellctl.errors import CellError
from cellctl.geometry.pose import MM

_LEAST_WITHOUT = 5
"""Touches of which one may be left out: four are needed, and four may fit by luck."""
_LONGEST_M = 2.0
"""From flange to tip; longer tools no arm of this size carries."""


def tool_mistakes(touching: Sequence[RigidTransform], result: ToolResult) -> tuple[str, ...]:
    """What is probably wrong with the poses, as warnings; empty for good ones."""
    said = []
    tip_m = np.asarray(result.flange_T_tool.pose.translation)
    failed = {check.name for check in result.checks if not check.passed}
    # Of the axes, which say nothing of how the touches fit.
    backwards = Z_FORWARDS in failed
    failed -= {Z_FORWARDS}
    if failed == {TIP_FROM_FLANGE}:
        said.append(
            "the poses are inverted (flange_T_base)? The tool would be longer than the arm reaches"
        )
    elif failed and (hint := _explanation(touching)):
        said.append(hint)
    if np.linalg.norm(tip_m) > _LONGEST_M:
        said.append(f"the tip is {np.linalg.norm(tip_m) / MM:.0f} mm from the flange")
    if backwards:
        said.append(
            "z of the tool points from its tip back to the flange: are the second and the third "
            "of the orienting poses exchanged, or was the tip moved along -x or -y?"
        )
    return tuple(said)


def _explanation(touching: Sequence[RigidTransform]) -> str:
    if _passes([meant_in_radians(pose) for pose in touching]):
        return "the angles of the poses are in radians? Then the touches meet in one point"
    if len(touching) >= _LEAST_WITHOUT:
        alone = [
            number
            for number in range(len(touching))
            if _passes([*touching[:number], *touching[number + 1 :]])
        ]
        if len(alone) == 1:
            return f"touching, entry {alone[0] + 1} does not fit the others, which fit without it"
    return ""


def _passes(touching: Sequence[RigidTransform]) -> bool:
    try:
        return calibrate_tool(touching).passed
    except CellError:
        return False
