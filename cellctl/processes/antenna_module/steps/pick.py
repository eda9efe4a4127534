"""Step 30: the gripper takes the module off its tray and weighs it."""

import asyncio

import numpy as np

from cellctl.cell.guarded_motion.settling import settle
from cellctl.clock import now_s
from cellctl.geometry.pose import MM, Array, pose_from_xyzabc
from cellctl.processes.antenna_module.faults.plugging import WrongModuleMass
from cellctl.processes.antenna_module.moves.places import raised
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.state import HeldModule, ModuleFound, Picked
from cellctl.records.figures import Limit

_G_M_S2 = 9.80665


async def pick(found: ModuleFound) -> Picked:
    """Down onto the module, close, straight up again, weigh.

    Raises ``WrongModuleMass``, the gripper's faults, and the trip of a fingers' touch on the way.
    """
    run = found.run
    grip = found.base_T_connector * pose_from_xyzabc(run.recipe.flange_T_plug).inv()
    above = raised(grip, run.recipe.grip_approach_mm * MM)
    await run.mover.to(above)
    empty_n = await _force_n(run)
    await run.mover.slowly_to(grip)
    await run.cell.gripper.close()
    gripped = run.cell.arm.robot.state().base_T_flange
    await run.mover.slowly_to(above)
    # Asked again in the air: on the tray a part lies between the jaws whether they hold it or not.
    await run.cell.gripper.confirm_part()
    # The arm is in the same orientation, so what the sensor itself is off drops out.
    hanging_n = await _force_n(run)
    module_kg = float(np.linalg.norm(hanging_n - empty_n)) / _G_M_S2
    await _require_mass(run, module_kg)
    # By the same camera as the look after the release, from as far away, and of the same marks:
    # what camera and drawing are wrong by drops out of the difference.
    top_over_flange_m = found.top_height_m - float(gripped.translation[2])
    module = HeldModule(module_kg, hanging_n, top_over_flange_m)
    return Picked(run, module, base_T_grip=grip)


async def _force_n(run: PluggingRun) -> Array:
    """Mean raw force, shape (3,), once nothing swings any more."""
    guard = run.cell.arm.guard
    await settle(guard)
    begin_s = now_s()
    await asyncio.sleep(guard.settling.reading_s)
    return np.asarray(guard.samples(begin_s).raw[:, :3].mean(axis=0))


async def _require_mass(run: PluggingRun, module_kg: float) -> None:
    drawn_kg, ratio = run.recipe.module_mass_kg, run.recipe.mass_tolerance_ratio
    limit = Limit(drawn_kg * (1 - ratio), drawn_kg * (1 + ratio))
    await run.recorder.figure(keys.MASS, module_kg, "kg", limit=limit)
    if not abs(module_kg - drawn_kg) <= ratio * drawn_kg:
        raise WrongModuleMass(f"{module_kg:.3f} kg, by the recipe {drawn_kg:g} kg ± {ratio:.0%}")
