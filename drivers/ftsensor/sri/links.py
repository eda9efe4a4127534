"""The parts that belong to each transport: connection, decoder, start-up and stop."""

from collections.abc import Callable
from dataclasses import dataclass

from drivers.ftsensor.sri.config import SriConfig
from drivers.ftsensor.sri.connection import Connection
from drivers.ftsensor.sri.protocol import StreamDecoder, command
from drivers.ftsensor.sri.session import Decoder
from drivers.ftsensor.sri.startup import AtCommandStartUp, CanStartUp, StartUp


@dataclass(frozen=True, slots=True)
class Link:
    """One transport; the connection is reused, decoder and start-up are made for each session."""

    connection: Connection
    decoder: Callable[[], Decoder]
    start_up: Callable[[], StartUp]
    stop: bytes


def link_for(config: SriConfig) -> Link:
    """The transport of a configuration. Libraries of the others are not imported."""
    if config.transport == "can":
        from drivers.ftsensor.sri.can_frames import TripleDecoder
        from drivers.ftsensor.sri.transports.can_bus import CanConnection

        return Link(
            CanConnection(config),
            lambda: TripleDecoder(config.can_data_ids),
            lambda: CanStartUp().run(),
            CanStartUp.STOP,
        )
    return Link(
        _stream_connection(config),
        lambda: StreamDecoder(config.layout),
        lambda: AtCommandStartUp(config).run(),
        command("GSD", "STOP"),
    )


def _stream_connection(config: SriConfig) -> Connection:
    if config.transport == "serial":
        from drivers.ftsensor.sri.transports.serial_line import SerialConnection

        return SerialConnection(config.device, config.baud)
    from drivers.ftsensor.sri.transports.tcp import TcpConnection

    return TcpConnection(config.host, config.port)
