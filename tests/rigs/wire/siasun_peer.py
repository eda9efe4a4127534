"""A scripted controller end of one SJL/1 channel: literal lines, sums made here by hand."""

import asyncio
from typing import Self

POSE = "1900.0000,-0.1250,927.0000,90.0000,0.0000,180.0000"
JOINTS = "0.00000,-45.00000,90.00000,0.00000,45.00000,0.00000"


def line(body: str) -> bytes:
    """A record with its sum."""
    return f"{body}*{sum(body.encode()) % 256:02X}\n".encode()


class Peer:
    """One channel. Methods fail within two seconds."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader, self.writer = reader, writer
        self.session = ""
        self.count = 0

    @classmethod
    async def connect(cls, port: int, address: str = "127.0.0.1") -> Self:
        """Try until the driver listens, at most two seconds; from an address of this machine."""
        source = (address, 0)
        async with asyncio.timeout(2):
            while True:
                try:
                    return cls(*await asyncio.open_connection("127.0.0.1", port, local_addr=source))
                except ConnectionRefusedError:
                    await asyncio.sleep(0.01)

    @classmethod
    async def greeted(
        cls,
        port: int,
        channel: str,
        option: str = "",
        address: str = "127.0.0.1",
        **changes: str,
    ) -> Self:
        """Connected and accepted."""
        peer = await cls.connect(port, address)
        await peer.hello(channel, option=option, **changes)
        return peer

    async def hello(
        self, channel: str, robot: str = "SR500A", option: str = "", **changes: str
    ) -> str:
        """Say hello and return the answer without its sum."""
        words = {"version": "1", "eul": "ZYX", "unit": "MMDEG", "deadman": "300"} | changes
        self.send(
            f"HELLO,SJL,{words['version']},{channel},{robot},1.0,EUL={words['eul']},"
            f"UNIT={words['unit']},STEPMAX=0.5000,DEADMAN={words['deadman']}"
            f"{',' if option else ''}{option}"
        )
        answer = await self.expect()
        self.session = answer.rpartition(",")[2]
        return answer

    def send(self, body: str) -> None:
        self.writer.write(line(body))

    def stat(
        self, flags: str = "REM,0,1,0,0,0,100", pose: str = POSE, joints: str = JOINTS
    ) -> None:
        """Send the next state report."""
        self.count += 1
        self.send(f"STAT,{self.count},{self.count * 20},{flags},{pose},{joints}")

    async def expect(self) -> str:
        """The next record, its sum checked and taken off."""
        async with asyncio.timeout(2):
            raw = await self.reader.readuntil(b"\n")
        body = raw.decode().rpartition("*")[0]
        assert raw == line(body)
        return body

    async def expect_word(self, word: str) -> str:
        """The next record that starts with a word; others (heartbeats) are passed over."""
        while not (body := await self.expect()).startswith(word):
            pass
        return body

    async def closed(self) -> None:
        """Wait until the driver has closed this channel."""
        async with asyncio.timeout(2):
            try:
                while await self.reader.read(4096):
                    pass
            except ConnectionResetError:
                return

    async def close(self) -> None:
        self.writer.transport.abort()
        await asyncio.gather(self.writer.wait_closed(), return_exceptions=True)
