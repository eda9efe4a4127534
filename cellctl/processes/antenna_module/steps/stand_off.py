"""Step 70: the tips over the socket's face, still; the force counts from here."""

import numpy as np

from cellctl.cell.guarded_motion.guarded_moves import TARE_S
from cellctl.cell.guarded_motion.kept_zero import Pressed, keep_zero
from cellctl.cell.guarded_motion.settling import settle
from cellctl.clock import now_s
from cellctl.errors.force import TareImplausible
from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.mated import connector_T_plug
from cellctl.processes.antenna_module.moves.places import OVER_SOCKET_M, raised
from cellctl.processes.antenna_module.pushing.way import InsertionWay
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.state import OverSocket, Planned

_TOUCH_N = 3.0
"""What arm and hoses may change of the raw force between two places in one orientation."""


async def stand_off(planned: Planned) -> OverSocket:
    """Beside the socket's panel no straight way is free: up, across, then down slowly.

    Raises ``PartLost`` for a module that was lost since it was picked, and ``TareImplausible`` when
    something but gripper and module is felt.
    """
    run = planned.run
    way = way_of(planned)
    target = way.pose_at(-run.recipe.insertion.stand_off_mm * MM)
    here = run.cell.arm.robot.state().base_T_flange
    over = raised(target, OVER_SOCKET_M)
    climb_m = max(0.0, float(over.translation[2] - here.translation[2]))
    await run.mover.to(raised(here, climb_m))
    await run.mover.to(over)
    await run.mover.slowly_to(target)
    await run.recorder.pose("stand_off", keys.COMMANDED, "base", "flange", target)
    reached = run.cell.arm.robot.state().base_T_flange
    await run.recorder.pose("stand_off", keys.REPORTED, "base", "flange", reached)
    # Before the tare: a light module is less than what may be felt beside it.
    await run.cell.gripper.confirm_part()
    await _tare(planned)
    return OverSocket(
        run,
        planned.module,
        plug=planned.plug,
        flange_T_connector=planned.flange_T_connector,
        looks=planned.looks,
        plan=planned.plan,
    )


def way_of(planned: Planned) -> InsertionWay:
    """The way down to where the plan has the plug seated."""
    socket = planned.run.drawings.socket
    flange_T_plug = planned.flange_T_connector * connector_T_plug(socket)
    return InsertionWay.of(planned.plan.base_T_flange.pose, flange_T_plug, socket.seat_depth_m)


async def _tare(planned: Planned) -> None:
    """Take what gripper and module weigh as zero, in the axes of the socket at the connector."""
    arm = planned.run.cell.arm
    # Frame and tare cannot be changed while armed: the signal would jump against the limits.
    await arm.guard.disarm()
    socket = planned.run.drawings.socket
    flange_T_plug = planned.flange_T_connector * connector_T_plug(socket)
    sensor_T_plug = arm.flange_T_sensor.inv() * flange_T_plug
    await arm.guard.set_wrench_frame(sensor_T_plug)
    await settle(arm.guard)
    await arm.guard.tare(TARE_S)
    # What is taken as zero is not seen any more: a plug that touches already would begin with a
    # hidden force. Hanging free it makes the force that it made over the tray.
    felt_n = arm.guard.samples(now_s() - TARE_S).raw[:, :3].mean(axis=0)
    changed_n = float(np.linalg.norm(felt_n - planned.module.hanging_n))
    if not changed_n <= _TOUCH_N:
        raise TareImplausible(
            f"{changed_n:.1f} N more or less than over the tray, allowed {_TOUCH_N:g} N"
        )
    await keep_zero(arm, sensor_T_plug, Pressed(inwards=-1.0, force_n=0.0))
