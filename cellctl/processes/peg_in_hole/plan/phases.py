"""The phases of a cycle, and how hard a contact may become in each before the guard stops the arm.

The guard's limits are no limits of the motions: those end far below. They follow from what a motion
may reach by its design, so that a motion that goes wrong is stopped near to that and not only at
the limit of the whole insertion. Source: sections 1 and 4.2 of the study of insertion by touch.
"""

from enum import StrEnum

from cellctl.processes.peg_in_hole.plan.derived import Derived
from cellctl.processes.peg_in_hole.plan.task import ForceLimits, SearchTask

_NOISE = 1.25
"""Factor on what a motion may reach, for noise of the sensor, inertia of the tool and friction."""


class CyclePhase(StrEnum):
    """What a cycle is doing."""

    FACE = "touch face"
    SEARCH = "search"
    INSERTION = "insert"
    VERDICT = "verify"


def guard_force(task: SearchTask, phase: CyclePhase) -> Derived:
    """Force (N) about the tip at which the guard stops the arm in a phase."""
    limits = task.limits
    value, formula = _FORCES[phase](limits)
    return Derived(
        f"guard, {phase.value}",
        min(value, limits.fault_n),
        "N",
        f"min({formula}, F_fault)",
        {"F_s": limits.search_n, "F_i": limits.insertion_n, "F_fault": limits.fault_n},
    )


def _first_touch(limits: ForceLimits) -> tuple[float, str]:
    # The first touch meets a face of unknown height as fast as the force may grow by F_i / 2.
    return _NOISE * (limits.search_n + limits.insertion_n / 2), "1.25 (F_s + F_i / 2)"


def _touch(limits: ForceLimits) -> tuple[float, str]:
    # A touch ends at F_s, and by then may grow by as much again before the arm has answered.
    return _NOISE * 2 * limits.search_n, "1.25 · 2 F_s"


def _feed(limits: ForceLimits) -> tuple[float, str]:
    return _NOISE * limits.insertion_n, "1.25 F_i"


_FORCES = {
    CyclePhase.FACE: _first_touch,
    CyclePhase.SEARCH: _touch,
    CyclePhase.INSERTION: _feed,
    # The pushes are light, but they begin at a seat that the feed has loaded.
    CyclePhase.VERDICT: _feed,
}
