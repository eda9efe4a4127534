"""Procedure 205: where axis, gripper marks and plate are, for later checks to compare with."""

from dataclasses import asdict

from cellctl.processes.antenna_module.calibrations import CALIBRATIONS, REFERENCE
from cellctl.processes.antenna_module.chain.cell_figures import ArmFigures
from cellctl.processes.antenna_module.chain.reference.reference_check import (
    require_nothing_moved,
)
from cellctl.processes.antenna_module.chain.reference.reference_looks import ReferenceLooks
from cellctl.processes.antenna_module.chain.reference.taught_reference import TaughtReference
from cellctl.processes.antenna_module.chain.teaching.made_with import ReferenceMadeWith
from cellctl.processes.antenna_module.facts import PluggingFacts, read_facts
from cellctl.processes.antenna_module.moves.moving import Mover
from cellctl.processes.antenna_module.moves.reference_drive import ReferenceDrive
from cellctl.processes.antenna_module.moves.start import leave_stations
from cellctl.processes.antenna_module.procedures.board_drive import eyes_of
from cellctl.processes.antenna_module.procedures.reference_picture import reference_picture
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.roles import HOME
from cellctl.processes.antenna_module.settings import ReferenceSection
from cellctl.processes.antenna_module.stations import AntennaCell
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome
from cellctl.runtime.process import CellServices


async def teach_reference_on_cell(
    cell: AntennaCell,
    recipe: AntennaRecipe,
    section: ReferenceSection,
    services: CellServices,
    context: ProcedureContext,
) -> ProcedureOutcome:
    """Turn the marks over camera II and look at the plate, often; the gripper is empty.

    A valid reference that was made with the same calibrations is compared first: raises the
    ``ReferenceMoved`` of what has moved since. That invalidates what depends on it, which the new
    reference would hide. Raises also what drive and store raise.
    """
    facts = await read_facts(cell, recipe, services.calibrations, CALIBRATIONS, teaching=True)
    await leave_stations(cell)
    await cell.gripper.open()

    async def tell(number: int, total: int) -> None:
        await context.progress(number, total, "look")

    plate = facts.required_plate
    drive = ReferenceDrive(facts, plate, eyes_of(context, cell), tell)
    looks = await drive.looks(section.taught_looks)
    await Mover(cell).to_taught(HOME)
    made_with, plug_cell = ReferenceMadeWith.of(facts.plug_cell), facts.plug_cell
    await context.keep_input(
        {
            "made_with": made_with.to_record(),
            "arm": asdict(plug_cell.arm),
            "flange_T_cam1": plug_cell.cam1.pose.pose.as_matrix().tolist(),
            "base_T_cam2": plug_cell.cam2.pose.pose.as_matrix().tolist(),
            "marks": [look.to_input() for look in drive.kept.marks],
            "above": [look.to_input() for look in drive.kept.above],
            "below": [look.to_input() for look in drive.kept.below],
        }
    )
    taught = reference_of(made_with, looks, plug_cell.arm)
    warnings = _since_last_time(facts, taught)
    return ProcedureOutcome(
        kind=REFERENCE,
        record=taught.to_record(),
        passed=taught.passed,
        warnings=warnings,
        picture_png=await cell.workers.run(reference_picture, looks, taught.checks),
        serial_number="",
    )


def reference_of(
    made_with: ReferenceMadeWith, looks: ReferenceLooks, arm: ArmFigures
) -> TaughtReference:
    """What is stored of the looks; raises ``TurnInvalid``."""
    return TaughtReference(made_with, looks.reading(arm), looks.checks(arm))


def _since_last_time(facts: PluggingFacts, taught: TaughtReference) -> tuple[str, ...]:
    before = facts.calibrations.find(REFERENCE)
    if before is None or before.made_with.differences(taught.made_with):
        return ()
    warmed = require_nothing_moved(before.reading, taught.reading, facts.plug_cell.arm.drift_m)
    return () if warmed is None else (f"arm has warmed up since the last time: {warmed.detail}",)
