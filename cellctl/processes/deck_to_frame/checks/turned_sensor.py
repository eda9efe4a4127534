"""A force sensor that is written in another turn about its axis than it was bolted on."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.config.cell import CellConfig
from cellctl.config.issue import ConfigIssue, WrittenValue
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.deck_to_frame.checks.plausible.stored import stored_record
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.record_names import PAYLOAD_NAME
from cellctl.processes.deck_to_frame.roles import FORCE, MAIN

_QUARTERS_DEG = (90.0, -90.0, 180.0)
"""Turns in which a sensor fits onto the same bolts."""


def turned_sensor_issues(
    cell: CellConfig, recipe: DeckRecipe, folder: Path
) -> Iterator[ConfigIssue]:
    """A pose with which the stored weighing contradicts the load, and a turned one with which both
    agree: two values against one."""
    record, main = stored_record(cell, folder, PAYLOAD_NAME), recipe.device(MAIN)
    load, name = cell.robots[main].load, recipe.device(FORCE)
    weighed = (record or {}).get("rigid12", {})
    com_mm, weighed_kg = weighed.get("centre_of_mass_mm"), weighed.get("mass_kg")
    if load is None or com_mm is None or weighed_kg is None:
        return
    # As procedure 106 compares them; loaded late, because it loads what moves arms.
    from cellctl.cell.arm_loads import weighed_checks

    def agrees(flange_T_sensor: RigidTransform) -> bool:
        checks = weighed_checks(load, weighed_kg, np.array(com_mm) * MM, flange_T_sensor)
        return all(check.passed for check in checks)

    written = cell.force_sensors[name].flange_T_sensor
    flange_T_sensor = pose_from_xyzabc(written)
    if agrees(flange_T_sensor):
        return
    for turn_deg in _QUARTERS_DEG:
        turn = RigidTransform.from_rotation(Rotation.from_euler("z", turn_deg, degrees=True))
        if agrees(flange_T_sensor * turn):
            meant = list(written)
            meant[3] = (meant[3] + turn_deg + 180.0) % 360.0 - 180.0
            allowed = (
                f"{meant}, turned about its z axis: so the stored {PAYLOAD_NAME} has the centre of "
                "mass where the load has it; with a sensor turned otherwise every force is turned"
            )
            load_text = f"{load.mass_kg:g} kg at {list(load.com_mm)} mm"
            yield ConfigIssue(
                f"force_sensors.{name}.flange_T_sensor",
                str(list(written)),
                allowed,
                against=(WrittenValue(f"robots.{main}.load", load_text),),
            )
            return
