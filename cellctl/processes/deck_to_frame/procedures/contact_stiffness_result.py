"""Judges a contact stiffness and writes it as plain data, in N/mm, mm and N."""

from typing import Any

import numpy as np

from cellctl.calibration.checks import Checks, LimitCheck, evidence_to_record
from cellctl.geometry.pose import MM
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


def stiffness_checks(measured: ContactStiffness, mating: Mating) -> Checks:
    """The verdict: does it repeat, is it a line, does the recipe's bound hold?"""
    estimate = measured.estimate
    starts_mm = np.array([single.contact_m for single in measured.single]) / MM
    peak_n = max(contact.statistics.peak_filtered_fz_n for contact in measured.contacts)
    percent = 100.0 * estimate.sigma_n_m / estimate.stiffness_n_m
    return (
        LimitCheck(STIFFNESS, estimate.stiffness_n_m * MM, mating.stiffness_n_per_mm, "N/mm"),
        LimitCheck("relative sigma", percent, SIGMA_PERCENT, "%"),
        LimitCheck("residual", estimate.residual_n, RESIDUAL_N, "N"),
        LimitCheck("spread of the touch points", float(np.ptp(starts_mm)), SPREAD_MM, "mm"),
        LimitCheck("peak force", peak_n, mating.limit_force_n, "N"),
    )


def stiffness_record(
    measured: ContactStiffness, checks: Checks, recipe_id: int, run_number: int
) -> dict[str, Any]:
    """What is stored; ``run_number`` leads to pictures and force curves."""
    estimate = measured.estimate
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
                "stiffness_n_per_mm": single.stiffness_n_m * MM,
                "sigma_n_per_mm": single.sigma_n_m * MM,
                "contact_mm": single.contact_m / MM,
                "residual_n": single.residual_n,
                "travel_mm": [reading.travel_m / MM for reading in readings_of(contact)],
                "force_n": [reading.force_n for reading in readings_of(contact)],
                "peak_force_n": contact.statistics.peak_fz_n,
            }
            for single, contact in zip(measured.single, measured.contacts, strict=True)
        ],
    }


def readings_of(contact: MatingResult) -> tuple[Reading, ...]:
    """Standstill readings in contact, oldest first."""
    return (*contact.creep, *contact.relaxing)
