"""A pneumatic gripper: a double solenoid valve and three sensors behind a Modbus TCP coupler."""

import asyncio
from collections.abc import Callable

from cellctl.clock import now_s
from cellctl.interfaces.gripper import Gripper, GripperState
from drivers.gripper.pneumatic import faults, protocol
from drivers.gripper.pneumatic.config import PneumaticGripperConfig
from drivers.gripper.pneumatic.connection import coupler


class PneumaticGripper(Gripper):
    """The coils stay switched on after a motion, so that a knock does not move the valve."""

    Config = PneumaticGripperConfig

    def __init__(self, name: str, config: PneumaticGripperConfig) -> None:
        self.name = name
        self._config = config
        self._coupler = coupler(name, config)

    async def connect(self) -> None:
        """Connect and check the coupler's watchdog. Idempotent."""
        await self._coupler.connect()

    async def disconnect(self) -> None:
        """Switch both coils off, which leaves the jaws as they are, and drop the link."""
        await self._coupler.disconnect()

    async def let_go(self) -> None:
        """Drop the link and switch nothing."""
        await self._coupler.let_go()

    async def state(self) -> GripperState:
        """Read the sensors now."""
        state = protocol.to_state(await self._coupler.read())
        # No position of the jaws shows both; a broken wire or a shifted sensor does, and then
        # neither is known.
        if state.opened and state.closed:
            raise faults.contradiction(self.name)
        return state

    async def open(self) -> GripperState:
        """Switch the valve to open and wait for the end position."""
        timeout_s = self._config.travel_timeout_s
        await self._coupler.write(protocol.TO_OPEN)
        state = await self._wait(lambda state: state.opened, timeout_s)
        if not state.opened:
            raise faults.not_opened(self.name, timeout_s, state)
        return state

    async def close(self) -> GripperState:
        """Switch the valve to close, wait for the jaws, then for the part sensor."""
        timeout_s = self._config.travel_timeout_s
        await self._coupler.write(protocol.TO_CLOSE)
        # Jaws first, part second: while they travel the part sensor may see the part that lies
        # between them.
        state = await self._wait(lambda state: state.closed, timeout_s)
        if not state.closed:
            raise faults.not_closed(self.name, timeout_s, state)
        state = await self._wait(lambda state: state.part_present, self._config.part_delay_s)
        if not state.part_present:
            raise faults.no_part(self.name)
        return state

    async def confirm_part(self) -> GripperState:
        """Read the sensors now and see that they show a gripped part."""
        state = await self.state()
        if not (state.closed and state.part_present):
            raise faults.part_lost(self.name, state)
        return state

    async def _wait(
        self, reached: Callable[[GripperState], bool], timeout_s: float
    ) -> GripperState:
        """The first state that has reached the goal, or the last one when the time is over."""
        deadline_s = now_s() + timeout_s
        while True:
            state = await self.state()
            if reached(state) or now_s() >= deadline_s:
                return state
            # The coupler tells nothing by itself; the sensors have to be asked again and again.
            await asyncio.sleep(self._config.poll_s)
