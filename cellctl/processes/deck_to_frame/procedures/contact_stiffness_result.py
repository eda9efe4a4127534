"""Judges a contact stiffness and writes it as plain data, in N/mm, mm and N."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cellctl.calibration.checks import Checks, LimitCheck, evidence_to_record
from cellctl.force.contact.commissioning import StiffnessEstimate, estimate_stiffness
from cellctl.geometry.pose import MM, Array
from cellctl.processes.deck_to_frame.mating.commissioning import ContactStiffness
from cellctl.processes.deck_to_frame.mating.result import MatingResult, Reading
from cellctl.processes.deck_to_frame.recipe import Mating

SIGMA_PERCENT = 20.0
"""Largest standard deviation of the stiffness over it: matings are planned with its upper bound,
which is three of them above."""
RESIDUAL_N = 3.0
"""A reading about the line: noise of force and length of single moves."""
SPREAD_MM = 0.06
"""Largest spread of the travels at which the contacts begin: about the repeatability of an arm."""


STIFFNESS = "stiffness"
"""Name of the check that holds the result against the bound of the recipe."""


@dataclass(frozen=True, slots=True, eq=False)
class Touch:
    """One contact as the record has it; readings at standstill in contact, oldest first."""

    estimate: StiffnessEstimate
    travel_m: Array
    """Shape (n,)."""
    force_n: Array
    """Along the approach, shape (n,)."""
    peak_n: float
    peak_filtered_n: float

    @classmethod
    def of(cls, estimate: StiffnessEstimate, contact: MatingResult) -> "Touch":
        """A contact with the stiffness that was found in it."""
        readings = readings_of(contact)
        return cls(
            estimate,
            np.array([reading.travel_m for reading in readings]),
            np.array([reading.force_n for reading in readings]),
            contact.statistics.peak_fz_n,
            contact.statistics.peak_filtered_fz_n,
        )

    def to_input(self) -> dict[str, Any]:
        """Plain data with all digits, without what is computed from them."""
        return {
            "travel_m": self.travel_m.tolist(),
            "force_n": self.force_n.tolist(),
            "peak_n": self.peak_n,
            "peak_filtered_n": self.peak_filtered_n,
        }

    @classmethod
    def from_input(cls, written: Mapping[str, Any]) -> "Touch":
        """The contact with the stiffness that follows from its readings.

        Raises ``CommissioningFailed``.
        """
        travel_m, force_n = (np.array(written[name], float) for name in ("travel_m", "force_n"))
        estimate = estimate_stiffness(travel_m, force_n)
        return cls(estimate, travel_m, force_n, written["peak_n"], written["peak_filtered_n"])


def touches_of(measured: ContactStiffness) -> tuple[Touch, ...]:
    """All contacts of a measurement."""
    return tuple(map(Touch.of, measured.single, measured.contacts))


def stiffness_checks(
    estimate: StiffnessEstimate, touches: Sequence[Touch], mating: Mating
) -> Checks:
    """The verdict: does it repeat, is it a line, does the recipe's bound hold?"""
    starts_mm = np.array([touch.estimate.contact_m for touch in touches]) / MM
    peak_n = max(touch.peak_filtered_n for touch in touches)
    percent = 100.0 * estimate.sigma_n_m / estimate.stiffness_n_m
    return (
        LimitCheck(STIFFNESS, estimate.stiffness_n_m * MM, mating.stiffness_n_per_mm, "N/mm"),
        LimitCheck("relative sigma", percent, SIGMA_PERCENT, "%"),
        LimitCheck("residual", estimate.residual_n, RESIDUAL_N, "N"),
        LimitCheck("spread of the touch points", float(np.ptp(starts_mm)), SPREAD_MM, "mm"),
        LimitCheck("peak force", peak_n, mating.limit_force_n, "N"),
    )


def stiffness_record(
    estimate: StiffnessEstimate,
    touches: Sequence[Touch],
    checks: Checks,
    *,
    recipe_id: int,
    run_number: int,
) -> dict[str, Any]:
    """What is stored; ``run_number`` leads to pictures and force curves."""
    return {
        **evidence_to_record("contact stiffness", checks),
        "recipe_id": recipe_id,
        "run": run_number,
        "stiffness_n_per_mm": estimate.stiffness_n_m * MM,
        "sigma_n_per_mm": estimate.sigma_n_m * MM,
        "upper_n_per_mm": estimate.upper_n_m * MM,
        "residual_n": estimate.residual_n,
        "contacts": [
            {
                "stiffness_n_per_mm": touch.estimate.stiffness_n_m * MM,
                "sigma_n_per_mm": touch.estimate.sigma_n_m * MM,
                "contact_mm": touch.estimate.contact_m / MM,
                "residual_n": touch.estimate.residual_n,
                "travel_mm": (touch.travel_m / MM).tolist(),
                "force_n": touch.force_n.tolist(),
                "peak_force_n": touch.peak_n,
            }
            for touch in touches
        ],
    }


def readings_of(contact: MatingResult) -> tuple[Reading, ...]:
    """Standstill readings in contact, oldest first."""
    return (*contact.creep, *contact.relaxing)
