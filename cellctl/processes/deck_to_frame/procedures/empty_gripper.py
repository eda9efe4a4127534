"""Whether the deck was left in the gripper of a procedure that needs its space."""

import asyncio
from dataclasses import replace

import numpy as np

from cellctl.clock import utc_now
from cellctl.procedures.payload import still_wrench
from cellctl.processes.deck_to_frame.calibrations import PAYLOAD
from cellctl.processes.deck_to_frame.faults import DeckInGripper
from cellctl.processes.deck_to_frame.stations import DeckCell
from cellctl.runtime.process import CellServices

_OPTIONAL_PAYLOAD = replace(PAYLOAD, required=False)
"""A run requires it; these procedures may come before it."""


async def require_no_deck(cell: DeckCell, services: CellServices) -> None:
    """Raise ``DeckInGripper`` where the force sensor carries what procedure 106 weighed with it.

    The arm stands still. Without a valid result of 106 nobody knows what a deck weighs, and the
    guide alone asks a person to take it out. Raises ``NotSettled`` or ``SensorSilent``: a sensor
    that does not answer does not show an empty gripper.
    """
    snapshot = await asyncio.to_thread(
        services.calibrations.read_all, [_OPTIONAL_PAYLOAD], utc_now()
    )
    payload = snapshot.find(PAYLOAD)
    if payload is None:
        return
    rotation, raw = await still_wrench(cell.main, cell.guard, cell.arm.flange_T_sensor)
    left_n = float(np.linalg.norm(payload.gravity_compensation.apply(raw, rotation)[:3]))
    # In a run, more than this after the compensation means another payload; so less means this one.
    bound_n = min(recipe.mating.max_untared_force_n for recipe in cell.recipes)
    if left_n <= bound_n:
        raise DeckInGripper(
            f"the sensor reads the payload of procedure 106, {payload.mass_kg:.1f} kg, to within "
            f"{left_n:.0f} N; another payload differs by more than max_untared_force_n, "
            f"{bound_n:.0f} N"
        )
