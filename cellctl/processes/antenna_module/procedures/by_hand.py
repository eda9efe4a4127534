"""Waits while somebody jogs the arm at its panel."""

import asyncio
from dataclasses import dataclass

from cellctl.clock import now_s
from cellctl.errors import CellError
from cellctl.interfaces import Robot, RobotMode


@dataclass(frozen=True, slots=True)
class Patience:
    """How long somebody at the panel is waited for, each time, and how often the arm is asked."""

    wait_s: float = 900.0
    poll_s: float = 0.1


PATIENCE = Patience()


async def jogged_by_hand(robot: Robot, nobody: type[CellError], patience: Patience) -> None:
    """Until the key was turned to manual and back, and the arm stands; raises ``nobody``."""
    give_up_s = now_s() + patience.wait_s
    by_hand = False
    while True:
        state = robot.state()
        if state.mode is not RobotMode.REMOTE:
            by_hand = True
        elif by_hand and state.ready and not state.moving:
            return
        if now_s() > give_up_s:
            raise nobody(f"nothing happened at the panel for {patience.wait_s / 60:.0f} minutes")
        await asyncio.sleep(patience.poll_s)
