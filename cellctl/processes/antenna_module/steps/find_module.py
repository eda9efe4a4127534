"""Step 20: camera I finds the module on its tray by the marks on its top."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import MM, pose_error, pose_from_xyzabc
from cellctl.processes.antenna_module.faults.connector import (
    ConnectorAmbiguous,
    ConnectorMisplaced,
    ConnectorTurned,
    ImageMirrored,
    MarksMissing,
)
from cellctl.processes.antenna_module.faults.plugging import ModuleMisplaced, ModuleMissing
from cellctl.processes.antenna_module.looking import combined, height_by_size, marks_by, nominal
from cellctl.processes.antenna_module.moves.places import shifted
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.roles import TRAY_LOOK
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.state import GripperEmpty, ModuleFound


async def find_module(ready: GripperEmpty) -> ModuleFound:
    """Look, bring the camera over the module, look again.

    Raises ``ModuleMissing`` or ``ModuleMisplaced``.
    """
    return await find_on_tray(ready.run, "tray")


async def find_on_tray(run: PluggingRun, images: str) -> ModuleFound:
    """The step itself; the names of its raw images begin with ``images``."""
    await run.mover.to_taught(TRAY_LOOK)
    first = await _look(run, f"{images}-1")
    drawn = nominal(run.recipe.base_T_tray_plug)
    # Seen in the middle of the image, errors of lens and height count least.
    x_m, y_m, _ = (first.base_T_connector.translation - drawn.translation).tolist()
    here = run.cell.arm.robot.state().base_T_flange
    await run.mover.to(shifted(here, x_m, y_m))
    found = await _look(run, f"{images}-2")
    await run.recorder.pose(keys.TRAY, keys.MEASURED, "base", "plug", found.base_T_connector)
    return ModuleFound(run, found.base_T_connector, found.top_height_m)


@dataclass(frozen=True, slots=True, eq=False)
class _OnTray:
    base_T_connector: RigidTransform
    """Pose of the connector, at the height of the drawing and level."""
    top_height_m: float


async def _look(run: PluggingRun, name: str) -> _OnTray:
    place = run.recipe.base_T_tray_plug
    connector_T_top = pose_from_xyzabc(run.recipe.plug_T_top)
    plug_cell = run.facts.plug_cell
    base_T_cam1 = plug_cell.base_T_cam1(run.cell.arm.robot.state().base_T_flange)
    expected = base_T_cam1.inv() * nominal(place) * connector_T_top
    measure = marks_by(run.facts.camera_1, run.drawings.top, expected, place)
    try:
        seen = await run.eyes.look(name, run.cell.camera_1, measure)
    except MarksMissing as fault:
        raise ModuleMissing(fault.detail) from fault
    except (ImageMirrored, ConnectorAmbiguous, ConnectorTurned, ConnectorMisplaced) as fault:
        raise ModuleMisplaced(fault.detail) from fault
    top = combined(tuple(marks.camera_T_marks for marks in seen.frames)).pose
    # From the place where the images were taken, not from where the arm was told to go.
    base_T_cam1 = plug_cell.base_T_cam1(seen.base_T_flange)
    found = base_T_cam1 * top * connector_T_top.inv()
    _require_near(nominal(place), found, place.within_mm * MM, np.radians(place.within_deg))
    return _OnTray(found, height_by_size(base_T_cam1, seen.frames))


def _require_near(
    drawn: RigidTransform, found: RigidTransform, within_m: float, within_rad: float
) -> None:
    offset_m, turn_rad = pose_error(drawn, found)
    distance_m, angle_rad = float(np.linalg.norm(offset_m)), float(np.linalg.norm(turn_rad))
    if not (distance_m <= within_m and angle_rad <= within_rad):
        raise ModuleMisplaced(
            f"{distance_m / MM:.2f} mm and {np.degrees(angle_rad):.2f}° from its place, permitted "
            f"are {within_m / MM:g} mm and {np.degrees(within_rad):g}°"
        )
