"""Waits while somebody jogs the arm at its panel."""

import asyncio

from cellctl.clock import now_s
from cellctl.errors import CellError
from cellctl.interfaces import Robot, RobotMode

PATIENCE_S = 900.0
"""For the operator, each time."""
_POLL_S = 0.1


async def jogged_by_hand(robot: Robot, nobody: type[CellError]) -> None:
    """Until the key was turned to manual and back, and the arm stands; raises ``nobody``."""
    give_up_s = now_s() + PATIENCE_S
    by_hand = False
    while True:
        state = robot.state()
        if state.mode is not RobotMode.REMOTE:
            by_hand = True
        elif by_hand and state.ready and not state.moving:
            return
        if now_s() > give_up_s:
            raise nobody(f"nothing happened at the panel for {PATIENCE_S / 60:.0f} minutes")
        await asyncio.sleep(_POLL_S)
