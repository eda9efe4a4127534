"""Procedure 206: teaches the plug correction from plugs that somebody puts in by hand.

The cell finds, picks and looks as in production, then waits above the socket. The operator turns
the key to manual, jogs the plug into its socket by feel until it sits, and turns the key back. What
the flange reports then, beside what the cameras have seen, is one taught plug.
"""

import asyncio

from scipy.spatial.transform import RigidTransform

from cellctl.cell.guarded_motion.settling import settle
from cellctl.clock import now_s
from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.calibrations import CALIBRATIONS, PLUG_CORRECTION
from cellctl.processes.antenna_module.chain.teaching.taught_check import checked_with
from cellctl.processes.antenna_module.chain.teaching.taught_picture import taught_picture
from cellctl.processes.antenna_module.chain.teaching.teaching import TaughtPlug, teach_plug
from cellctl.processes.antenna_module.facts import read_facts
from cellctl.processes.antenna_module.faults.calibration import NobodyPlugged
from cellctl.processes.antenna_module.faults.plugging import ModuleMissing
from cellctl.processes.antenna_module.mated import connector_T_plug
from cellctl.processes.antenna_module.moves.places import OVER_SOCKET_M, WAITING_M, raised
from cellctl.processes.antenna_module.moves.start import move_to_start
from cellctl.processes.antenna_module.procedures.by_hand import PATIENCE, jogged_by_hand
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.state import GripperEmpty, SocketLocated
from cellctl.processes.antenna_module.stations import AntennaCell
from cellctl.processes.antenna_module.steps.find_module import find_module
from cellctl.processes.antenna_module.steps.inspect_plug import inspect_plug
from cellctl.processes.antenna_module.steps.locate_socket import locate_socket
from cellctl.processes.antenna_module.steps.pick import pick
from cellctl.records.run_recorder import RunRecorder
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome
from cellctl.runtime.process import CellServices, RunContext

MODE = "teaching"
SLOT = "1"
"""Name of the one socket that a recipe has."""
_LOOK_AGAIN_S = 2.0


async def teach_plug_on_cell(
    cell: AntennaCell, recipe: AntennaRecipe, services: CellServices, context: ProcedureContext
) -> ProcedureOutcome:
    """Teach as many plugs as the settings say, then check the correction with further ones.

    Everything goes into a run of its own.

    Raises ``TeachScatter``, ``NobodyPlugged``, and what the steps raise.
    """
    await context.record.look_at_files(recipe)
    facts = await read_facts(cell, recipe, services.calibrations, CALIBRATIONS, teaching=True)
    number = await context.record.open(recipe, MODE, facts.calibrations.records)
    recorder = RunRecorder(services.store, number)
    opened = RunContext(recorder, context.safe_point)
    plugs: list[TaughtPlug] = []
    taught = cell.settings.taught_plugs
    total = taught + cell.settings.checked_plugs
    for count in range(1, total + 1):
        await context.progress(count, total, "plug")
        run = PluggingRun.of(facts, services, opened, prefix=f"plug-{count}/", keep_images=False)
        name = f"plug {count}" if count <= taught else f"checked plug {count - taught}"
        plugs.append(await _one_plug(run, name))
        if count == taught:
            # Before anybody plugs for a check of something that is refused anyway.
            correction = teach_plug({SLOT: plugs}, facts.plug_cell, facts.scheme)
    correction = checked_with(correction, plugs[taught:], facts.plug_cell, facts.scheme)
    picture = await cell.workers.run(taught_picture, correction)
    await recorder.artefact(keys.TAUGHT_PICTURE, picture, "image/png")
    return ProcedureOutcome(
        kind=PLUG_CORRECTION.for_recipe(recipe.id),
        record=correction.to_record(),
        passed=correction.passed,
        warnings=(),
        picture_png=picture,
        serial_number="",
    )


async def _one_plug(run: PluggingRun, name: str) -> TaughtPlug:
    await move_to_start(run)
    located = await _looked_at(run)
    await _wait_above(located)
    run.say("plug by hand: key to manual, jog until it sits, key back to remote")
    await jogged_by_hand(run.cell.arm.robot, NobodyPlugged, PATIENCE)
    await settle(run.cell.arm.guard)
    base_T_flange = run.cell.arm.robot.state().base_T_flange
    await run.cell.gripper.open()
    await run.mover.slowly_to(raised(base_T_flange, run.recipe.grip_approach_mm * MM))
    return TaughtPlug(name, located.looks, base_T_flange)


async def _looked_at(run: PluggingRun) -> SocketLocated:
    found = None
    give_up_s = now_s() + PATIENCE.wait_s
    while found is None:
        try:
            found = await find_module(GripperEmpty(run))
        except ModuleMissing:
            # Before every plug but the first the operator has the plugged module to take out.
            if now_s() > give_up_s:
                raise
            run.say("lay the next module on the tray")
            await asyncio.sleep(_LOOK_AGAIN_S)
    return await locate_socket(await inspect_plug(await pick(found)))


async def _wait_above(located: SocketLocated) -> None:
    """Wait above the socket as far as it is known without a correction: the operator does the
    rest."""
    run, look = located.run, located.looks.sockets[-1]
    base_T_socket = run.facts.plug_cell.base_T_cam1(look.base_T_flange) * look.camera_T_socket.pose
    socket = run.drawings.socket
    flange_T_plug = located.flange_T_connector * connector_T_plug(socket)
    up_m = socket.seat_depth_m + WAITING_M
    waiting = (
        base_T_socket * RigidTransform.from_translation([0.0, 0.0, up_m]) * flange_T_plug.inv()
    )
    over = raised(waiting, OVER_SOCKET_M)
    here = run.cell.arm.robot.state().base_T_flange
    climb_m = float(over.translation[2] - here.translation[2])
    await run.mover.to(raised(here, max(0.0, climb_m)))
    await run.mover.to(over)
    await run.mover.slowly_to(waiting)
