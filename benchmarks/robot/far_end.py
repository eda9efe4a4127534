"""The far end of the benchmark: the fake controller and an echo, in a process of their own.

It stamps with the clock of the machine, which is the same in every process of it.
"""

import asyncio
import time
from multiprocessing.connection import Connection

from fakes.wire.duco.controller import DucoController
from fakes.wire.duco.logic import DucoLogic
from tests.rigs.wire.standing_arm import standing_arm

WATCH_S = 0.001

Stamp = tuple[str, float]
"""``stop``: a stop has arrived; ``halt``: the arm was told to stop; ``stand``: it stands."""


class StampedLogic(DucoLogic):
    """Notes when a stop arrives and when the arm is told to stop, by whatever way."""

    stamps: list[Stamp]

    def stop(self) -> int:
        self.stamps.append(("stop", time.monotonic()))
        return super().stop()

    def _halt(self) -> None:
        if self.moving() and not self._stopping:
            self.stamps.append(("halt", time.monotonic()))
        super()._halt()


def serve(pipe: Connection) -> None:
    """Tell the three ports; then ``move`` begins a slow turn, ``stamps`` asks for the stamps since,
    ``refuse`` lets the next call that moves the arm be answered with -1, ``end`` ends."""
    asyncio.run(_serve(pipe))


async def _serve(pipe: Connection) -> None:
    logic = StampedLogic(*standing_arm())
    logic.stamps = []
    controller = DucoController(logic)
    await controller.start()
    echo = await asyncio.start_server(_echo, "127.0.0.1", 0)
    pipe.send((controller.rpc_port, controller.state_port, echo.sockets[0].getsockname()[1]))
    while (word := await asyncio.to_thread(pipe.recv)) != "end":
        if word == "move":
            logic.stamps.clear()
            sign = -1.0 if logic.joints()[0] > 0.0 else 1.0
            logic.move_joint([sign * 0.8, *logic.joints()[1:]], 10.0)
            pipe.send(None)
        elif word == "refuse":
            logic.faults.inject("minus_one", count=1)
            pipe.send(None)
        else:
            while logic.moving():  # noqa: ASYNC110 - the arm tells nobody
                await asyncio.sleep(WATCH_S)
            logic.stamps.append(("stand", time.monotonic()))
            pipe.send(logic.stamps)
    echo.close()
    await controller.stop()


async def _echo(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    while data := await reader.read(4096):
        writer.write(data)
    writer.close()
