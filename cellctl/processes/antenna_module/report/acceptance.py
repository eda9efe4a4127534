"""What a plugging must fulfil: the module in its place first, then the insertion, then the plan."""

from cellctl.processes.antenna_module.record import keys
from cellctl.records.entries import RunRecord
from cellctl.records.report.acceptance.requirement import (
    RequirementGroup,
    of_figures,
    unmeasured,
)

_GROUPS = (
    (
        "Plugged module",
        "after release",
        {
            keys.PLACED: "lateral offset of the module from its place, by camera I",
            keys.PLACED_TURN: "rotation of the module about the axis of the socket, by camera I",
            keys.GAP: "height of the module over its seat, by camera I",
            keys.SEAT_DEPTH: "depth at which the seat was felt, by travel of the arm",
            keys.PULL: "pull test: force that the plug withstood",
            keys.PULL_TRAVEL: "pull test: travel",
        },
    ),
    (
        "Insertion",
        "axes of the socket, gravity removed",
        {
            keys.TOTAL: "greatest force along the axis",
            keys.SIDE: "greatest lateral force",
            keys.MOMENT_Z: "greatest moment about the axis",
        },
    ),
    (
        "Before the insertion",
        "",
        {
            keys.WORST_CONTACT: "worst contact to its hole, 99 % bound of the prediction",
            keys.GRIP_OFFSET: "module in the gripper: lateral offset",
            keys.GRIP_TURN: "module in the gripper: rotation about the axis",
            keys.MASS: "mass of the module, by the force sensor",
        },
    ),
)
_ALWAYS = (keys.PLACED, keys.PLACED_TURN, keys.SEAT_DEPTH, keys.TOTAL)
"""What every plugging has found that came to its end, in runs that do not say what they require."""
WORDS = {
    keys.REGRIPS: "times that the module was put back and gripped again",
    keys.SECOND_LOOKS: "looks that were taken a second time",
    keys.PEAK: "greatest force of the contact springs along the axis",
    keys.REFERENCE_MOVED: "greatest movement of the reference marks since the teaching",
}
"""Standard terms for the figures without a limit."""


def acceptance(record: RunRecord) -> tuple[RequirementGroup, ...]:
    """Every requirement on a plugging; what its run has ended without is not measured."""
    groups = []
    for title, note, titles in _GROUPS:
        rows = *of_figures(record, titles), *unmeasured(record, titles, _ALWAYS)
        groups.append(RequirementGroup(title, rows, note))
    return tuple(groups)
