"""The PC's end of SJL/1 for tests of the fake controller: listens, greets, beats."""

import asyncio
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from pathlib import Path

from fakes.faults import ROBOT_FAULTS, FaultBoard
from fakes.scenario_file.sections import Channel
from fakes.scenes.load import load
from fakes.wire.sjl.controller import SjlController
from fakes.wire.sjl.records import decode, encode
from fakes.world.robot import RobotArm
from fakes.world.truth import draw
from tests.rigs.wire.scenarios import as_on_a_real_cell

WAIT_S = 5.0
SCENARIO = as_on_a_real_cell(load(Path(__file__).parents[3] / "config" / "deck.scenario.toml"))


class Line:
    """One accepted connection, its records in the order of arrival."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader, self.writer = reader, writer
        self.hello: list[str] = []
        self.session = 0
        self.records: asyncio.Queue[list[str]] = asyncio.Queue()
        self.ended = asyncio.Event()

    def send(self, *fields: object) -> None:
        self.writer.write(encode([str(field) for field in fields]))

    async def next(self, *words: str) -> list[str]:
        """The next record that starts with one of the words."""
        async with asyncio.timeout(WAIT_S):
            while True:
                record = await self.records.get()
                if record[0] in words:
                    return record

    async def collect(self) -> None:
        try:
            with suppress(asyncio.IncompleteReadError, OSError):
                while True:
                    self.records.put_nowait(decode((await self.reader.readuntil(b"\n"))[:-1]))
        finally:
            self.ended.set()
            self.writer.close()


class Pc:
    """Listens on one port a channel and accepts every HELLO with a new session."""

    def __init__(self) -> None:
        self.arrivals: dict[str, asyncio.Queue[Line]] = {}
        self.answer: Callable[[int], list[str]] = lambda session: ["OK", "HELLO", "1", str(session)]
        self.beating = True
        self._sessions = 100
        self._servers: list[asyncio.Server] = []
        self._tasks: set[asyncio.Task[None]] = set()

    async def listen(self, channel: Channel) -> int:
        self.arrivals[channel] = asyncio.Queue()
        server = await asyncio.start_server(self._accept, "127.0.0.1", 0)
        self._servers.append(server)
        return int(server.sockets[0].getsockname()[1])

    async def accepted(self, channel: Channel) -> Line:
        return await asyncio.wait_for(self.arrivals[channel].get(), WAIT_S)

    async def close(self) -> None:
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        for server in self._servers:
            server.close()
            await server.wait_closed()

    async def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        line = Line(reader, writer)
        line.hello = decode((await reader.readuntil(b"\n"))[:-1])
        self._sessions += 1
        line.session = self._sessions
        writer.write(encode(self.answer(line.session)))
        for job in (line.collect(), self._beat(line)):
            self._tasks.add(asyncio.ensure_future(job))
        self.arrivals[line.hello[3]].put_nowait(line)

    async def _beat(self, line: Line) -> None:
        if line.hello[3] == "CMD":
            return
        count = 0
        while not line.ended.is_set():
            count += 1
            if self.beating:
                line.send("BEAT", line.session, count)
            await asyncio.sleep(0.05)


@asynccontextmanager
async def controller(pc: Pc, *channels: Channel) -> AsyncIterator[SjlController]:
    ports = {channel: await pc.listen(channel) for channel in channels}
    robot = SCENARIO.robots["main"]
    arm = RobotArm(robot, draw(SCENARIO, 1).robots["main"], 1)
    started_s = time.monotonic()
    device = SjlController(
        arm, lambda: time.monotonic() - started_s, ports, faults=FaultBoard("main", ROBOT_FAULTS)
    )
    device.start()
    try:
        yield device
    finally:
        await device.stop()
        await pc.close()
