"""A gripper in memory, whose jaws travel in real time."""

import asyncio

from cellctl.clock import now_s
from cellctl.errors.gripper import (
    GripperNotClosed,
    GripperNotOpened,
    GripperSensorsDisagree,
    NoPartGripped,
    PartLost,
)
from cellctl.errors.link import LinkLost, ReplyTimeout
from cellctl.interfaces.gripper import Gripper, GripperState

TRAVEL_S = 0.1


class InProcessGripper(Gripper):
    """Open, with a part between its jaws."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.part = True
        self.jammed = self.opened_for_ever = self.silent = False
        self.travels = 0
        self._closing = False
        self._arrival_s = 0.0
        self._connected = False

    @property
    def shut(self) -> bool:
        return self._closing and now_s() >= self._arrival_s

    async def connect(self) -> None:
        self._connected = True

    async def disconnect(self) -> None:
        self._connected = False

    def cut(self) -> None:
        self._connected = False

    async def state(self) -> GripperState:
        if self.silent:
            self._connected = False
            raise ReplyTimeout(self.name)
        if not self._connected:
            raise LinkLost(self.name)
        arrived = now_s() >= self._arrival_s
        opened = (arrived and not self._closing) or self.opened_for_ever
        if opened and self.shut:
            raise GripperSensorsDisagree(self.name)
        return GripperState(now_s(), opened, self.shut, self.part)

    async def open(self) -> GripperState:
        state = await self._travel(closing=False)
        if not state.opened:
            raise GripperNotOpened(self.name)
        return state

    async def close(self) -> GripperState:
        state = await self._travel(closing=True)
        if not state.closed:
            raise GripperNotClosed(self.name)
        if not state.part_present:
            raise NoPartGripped(self.name)
        return state

    async def confirm_part(self) -> GripperState:
        state = await self.state()
        if not (state.closed and state.part_present):
            raise PartLost(self.name)
        return state

    async def _travel(self, *, closing: bool) -> GripperState:
        await self.state()
        if closing is not self._closing and not self.jammed:
            self._closing, self._arrival_s = closing, now_s() + TRAVEL_S
            self.travels += 1
        while now_s() < self._arrival_s:
            await asyncio.sleep(0.01)
            await self.state()
        return await self.state()
