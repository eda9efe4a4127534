"""A large-field head behind a target server that speaks TGT/1 (docs/protocols/target-server.md)."""

from cellctl.interfaces.target_tracker import Target, TargetTracker
from drivers.camera.target_server import protocol
from drivers.camera.target_server.config import TargetServerConfig
from drivers.camera.target_server.connection import TargetServerConnection


class TargetServerTracker(TargetTracker):
    """Large-field tracker behind a server of targets.

    Between ``connect`` and ``disconnect`` a lost connection is made again by the next request; the
    request that lost it fails.
    """

    Config = TargetServerConfig

    def __init__(self, name: str, config: TargetServerConfig) -> None:
        self.name = name
        self._config = config
        self._connection = TargetServerConnection(name, config)

    async def connect(self) -> None:
        """Connect and see that a head answers."""
        await self._connection.link.take_up(self.serial_number)

    async def disconnect(self) -> None:
        """Drop the connection."""
        await self._connection.link.give_up()

    async def serial_number(self) -> str:
        """Serial number of the head."""
        await self._connection.link.restore()
        _, serial, _ = await self._connection.exchange(
            protocol.identify, protocol.parse_identity, self._config.reply_timeout_s
        )
        return serial

    async def measure(self, frames: int = 1) -> tuple[Target, ...]:
        """Visible targets, averaged over 1 to 200 frames; ``ValueError`` for another number."""
        if not 1 <= frames <= protocol.MAX_FRAMES:
            raise ValueError(f"frames must be 1 to {protocol.MAX_FRAMES}, got {frames}")
        await self._connection.link.restore()
        return await self._connection.exchange(
            lambda request_id: protocol.measure(request_id, frames),
            protocol.parse_targets,
            # An average over many frames takes its time; a fixed limit would have to be that of the
            # longest one.
            self._config.reply_timeout_s + frames * self._config.frame_timeout_s,
        )
