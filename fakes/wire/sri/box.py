"""The fake SRI interface box: one core, reached over TCP, a serial line (pty) or CAN.

    box = SriBox(sample)                    # sample(time_s) -> Fx, Fy, Fz, Mx, My, Mz at a time
    port = await box.start_tcp("127.0.0.1", 4008)
    box.faults.inject("frozen")
    await box.stop()

A frame is paced by the box's clock at the rate the client set, and carries the sample of its own
due time even when it leaves late.
"""

import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from fakes.wire.sri.core import SriCore
from fakes.wire.sri.faults import SriFaults
from fakes.wire.sri.links import Clock, Link, OnWrite
from fakes.wire.sri.serial import SerialLink
from fakes.wire.sri.settings import SriSettings
from fakes.wire.sri.tcp import TcpLink

if TYPE_CHECKING:
    import can


class SriBox:
    """A box with any number of links; everything runs in the event loop that starts them."""

    def __init__(
        self,
        sample: Callable[[float], Sequence[float]],
        *,
        settings: SriSettings | None = None,
        faults: SriFaults | None = None,
        clock: Clock = time.monotonic,
        on_write: OnWrite | None = None,
    ) -> None:
        self.core = SriCore(sample, settings, faults)
        self._clock = clock
        self._on_write = on_write
        self._links: list[Link] = []

    @property
    def faults(self) -> SriFaults:
        """Faults to inject or clear at any time."""
        return self.core.faults

    @property
    def settings(self) -> SriSettings:
        """Parameters as a client has left them."""
        return self.core.settings

    async def start_tcp(self, host: str = "127.0.0.1", port: int = 0) -> int:
        """Listen for clients; returns the port."""
        link = TcpLink(self.core, self._clock, self._on_write)
        self._links.append(link)
        return await link.start(host, port)

    async def start_serial(self, baud: int = 115200) -> str:
        """Offer RS232 on a pseudo terminal; returns its device file."""
        link = SerialLink(self.core, self._clock, self._on_write, baud)
        self._links.append(link)
        return link.path

    async def start_slcan(self) -> str:
        """Offer CAN behind an slcan adapter on a pseudo terminal; returns its device file."""
        # The import stands here so that a box without CAN does not load python-can.
        from fakes.wire.sri.can_links import SlcanLink

        link = SlcanLink(self.core, self._clock)
        self._links.append(link)
        return link.path

    async def start_can(self, bus: "can.BusABC") -> None:
        """Join a bus of python-can, which stays the caller's to close."""
        from fakes.wire.sri.can_links import BusLink

        self._links.append(BusLink(self.core, self._clock, bus))

    def drop_clients(self) -> None:
        """Break every TCP connection, as a power cut of the box does."""
        for link in self._links:
            if isinstance(link, TcpLink):
                link.drop_clients()

    async def stop(self) -> None:
        """Close every link. Idempotent."""
        while self._links:
            await self._links.pop().stop()
