"""Step 50: camera I sees the socket, from several approaches."""

from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.antenna_module.chain.looks import Looks, SocketLook
from cellctl.processes.antenna_module.faults.plugging import SocketUnsound
from cellctl.processes.antenna_module.looking import Seen, combined, connector_by, nominal
from cellctl.processes.antenna_module.moves.places import AWAY_M, shifted
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.record.pictures import record_picture
from cellctl.processes.antenna_module.roles import SOCKET_LOOK
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.state import PlugInspected, SocketLocated
from cellctl.processes.antenna_module.steps.look_again import SecondLook
from cellctl.processes.antenna_module.vision.measurement import (
    BAD_CONTACTS,
    ConnectorMeasurement,
    require_sound,
)
from cellctl.processes.antenna_module.vision.result_file import result_to_json


@dataclass(frozen=True, slots=True, eq=False)
class _SocketSight:
    """A socket with all of its holes."""

    seen: Seen[ConnectorMeasurement]
    socket: UncertainPose
    """``camera_T_socket``, combined from all frames."""


async def locate_socket(inspected: PlugInspected) -> SocketLocated:
    """Look once to find it, then bring the camera over it and look as often as the recipe says.

    Raises ``SocketUnsound`` for a blocked or missing hole, ``ConnectorMisplaced`` for a socket out
    of its place, and the other faults of ``measure_connector``.
    """
    run = inspected.run
    await run.mover.to_taught(SOCKET_LOOK)
    found = await _look(run, "socket-found")
    drawn = nominal(run.recipe.base_T_socket).translation
    x_m, y_m, _ = (_base_T_socket(run, found).translation - drawn).tolist()
    over = shifted(run.cell.arm.robot.state().base_T_flange, x_m, y_m)
    looks, sight = [], found
    for number in range(1, run.recipe.socket_looks + 1):
        run.say(f"look {number} of {run.recipe.socket_looks}")
        # Each look from an approach of its own: the mean of looks from one place would have the
        # whole error of that one approach.
        away_m = AWAY_M if number % 2 else -AWAY_M
        await run.mover.to(shifted(over, away_m, 0.0))
        await run.mover.to(over)
        sight = await _look(run, f"socket-{number}")
        looks.append(await _socket_look(run, number, sight))
    await record_picture(run, keys.SOCKET_PICTURE, sight.seen)
    await run.recorder.figure(keys.SECOND_LOOKS, len(run.second_looks), "")
    return SocketLocated(
        run,
        inspected.module,
        plug=inspected.plug,
        flange_T_connector=inspected.flange_T_connector,
        looks=Looks(inspected.plug, tuple(looks)),
    )


async def _look(run: PluggingRun, name: str) -> _SocketSight:
    """Measured and sound; where chance has spoilt the picture, from a second one."""
    try:
        return await SecondLook(run).look(name, partial(_measured, run))
    except BAD_CONTACTS as fault:
        raise SocketUnsound(fault.detail) from fault


async def _measured(run: PluggingRun, name: str) -> _SocketSight:
    base_T_cam1 = run.facts.plug_cell.base_T_cam1(run.cell.arm.robot.state().base_T_flange)
    place = run.recipe.base_T_socket
    expected = base_T_cam1.inv() * nominal(place)
    measure = connector_by(run.facts.camera_1, run.drawings.socket, expected, place)
    seen = await run.eyes.look(name, run.cell.camera_1, measure)
    try:
        for frame in seen.frames:
            require_sound(frame)
    except BAD_CONTACTS:
        await record_picture(run, keys.SOCKET_PICTURE, seen)
        raise
    return _SocketSight(seen, combined(tuple(frame.camera_T_connector for frame in seen.frames)))


def _base_T_socket(run: PluggingRun, sight: _SocketSight) -> RigidTransform:
    return run.facts.plug_cell.base_T_cam1(sight.seen.base_T_flange) * sight.socket.pose


async def _socket_look(run: PluggingRun, number: int, sight: _SocketSight) -> SocketLook:
    key, seen = f"{keys.SOCKET}.{number}", sight.seen
    recorder = run.recorder
    await recorder.measurement(key, "cam1", "socket", sight.socket, frames=len(seen.frames))
    await recorder.document(
        f"{keys.SOCKET_DETAIL}.{number}",
        {"images": [result_to_json(frame) for frame in seen.frames]},
    )
    return SocketLook(
        base_T_flange=seen.base_T_flange,
        joints_rad=np.asarray(seen.joints_rad),
        time_s=seen.time_s,
        camera_id=run.facts.camera_1.id,
        camera_T_socket=sight.socket,
        connector=run.drawings.socket.name,
    )
