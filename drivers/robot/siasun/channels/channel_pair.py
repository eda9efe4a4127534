"""Both channels of one robot, which serve only together: opened, checked and closed as one."""

import asyncio
from collections.abc import Callable

from cellctl.errors.base import CellError
from cellctl.errors.link import LinkError, LinkLost
from drivers.robot.siasun.channels.command_channel import CommandChannel
from drivers.robot.siasun.channels.state_channel import StateChannel
from drivers.robot.siasun.config import SiasunConfig


class ChannelPair:
    """CMD and STA of one robot. The callbacks are those of the two channels."""

    def __init__(
        self,
        robot: str,
        config: SiasunConfig,
        *,
        on_command_lost: Callable[[LinkError], None],
        on_stopped: Callable[[], None],
        on_state_lost: Callable[[LinkError], None],
    ) -> None:
        self.command = CommandChannel(robot, config, on_command_lost)
        self.state = StateChannel(robot, config, on_stopped, on_state_lost)
        self._config = config

    async def open(self) -> None:
        """Listen on both ports, wait for both sessions and for a first state report.

        Raises ``PortInUse``, the refusal of a wrong caller, or the time-out of the channel that is
        missing. Whatever it raises, also a cancellation, leaves ports open: the caller closes.
        """
        host, timeout_s = self._config.listen_host, self._config.connect_timeout_s
        command, state = self.command.channel, self.state.channel
        # Both ports before any wait, because the job programs of a robot connect in any order.
        await command.listen(host, self._config.command_port)
        await state.listen(host, self._config.state_port)
        try:
            async with asyncio.timeout(timeout_s):
                await command.wait_connected()
                await state.wait_connected()
                await self.state.wait(lambda _: True, timeout_s)
        except TimeoutError:
            missing = state if command.connected else command
            raise missing.timeout(timeout_s) from None

    def require_connected(self) -> None:
        """Raise ``LinkLost`` unless both sessions stand."""
        for channel in (self.command.channel, self.state.channel):
            if not channel.connected:
                raise LinkLost(f"{channel} is not connected")

    def incidents(self) -> tuple[CellError, ...]:
        """Strangers that have called on either port since the last call."""
        return (*self.command.channel.incidents(), *self.state.channel.incidents())

    async def close(self, fault: LinkError) -> None:
        """Close both channels; a command that still runs ends with this fault."""
        self.command.fail(fault)
        await self.command.channel.close()
        await self.state.close()
