"""A robot controller that speaks SJL/1, on the wire: its job programs connect to the PC.

Written from docs/protocols/sjl-1.md only. The main job holds CMD, background jobs hold STA and, on
the main robot, GRD. Each reconnects 0.5 s after its connection is lost or refused.
"""

import asyncio
import socket
from collections.abc import Callable
from contextlib import suppress

from fakes.faults import ROBOT_FAULTS, FaultBoard
from fakes.scenario_file.sections import Channel
from fakes.wire.sjl.logic import Controller, Outbox
from fakes.wire.sjl.records import (
    RECORD_MAX,
    RecordError,
    decode,
    encode,
    fixed,
    integer,
    joint_fields,
    pose_fields,
)
from fakes.wire.sjl.sender import Sender
from fakes.wire.sjl.stream import StreamOffer
from fakes.world.robot import RobotArm

JOB_VERSION = "1.0"
_RETRY_S = 0.5
"""Pause between two attempts to reach the PC (docs/protocols/sjl-1.md, section 1)."""
_HELLO_TIMEOUT_S = 2.0
"""Longest wait for the answer to a hello (section 3)."""
_STAT_PERIOD_S = 0.02
"""Time from report to report (section 6)."""
_TICK_S = 0.004
"""Job programs look at their sockets once in an interpolation cycle, which takes 4 to 12 ms."""


class SjlController:
    """``start`` begins to connect; ``stop`` drops all channels."""

    def __init__(
        self,
        arm: RobotArm,
        clock: Callable[[], float],
        ports: dict[Channel, int],
        *,
        host: str = "127.0.0.1",
        faults: FaultBoard | None = None,
        offer: StreamOffer | None = None,
        contact_closed: Callable[[], bool] = lambda: True,
    ) -> None:
        """``offer`` is what the job program offers for streamed motion, if anything.

        ``contact_closed`` tells of the PC's digital output in the permit loop.
        """
        self.faults = faults or FaultBoard("robot", ROBOT_FAULTS)
        self._arm, self._clock = arm, clock
        self._offer, self._contact_closed = offer, contact_closed
        self.logic = self._switched_on()
        self._host, self._ports = host, ports
        self._tasks: list[asyncio.Task[None]] = []
        self._senders: dict[Channel, Sender] = {}

    def start(self) -> None:
        """Begin to connect all channels and to run the controller."""
        for channel in self._ports:
            self._tasks.append(asyncio.create_task(self._keep_connected(channel)))
        self._tasks.append(asyncio.create_task(self._run()))

    async def stop(self) -> None:
        """Drop all channels. Idempotent."""
        tasks, self._tasks = self._tasks, []
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def reboot(self) -> None:
        """Switch off and on: channels drop, the latch is forgotten, joints stay."""
        self._arm.stop(self._clock(), latency_s=0.0)
        await self.stop()
        self.logic = self._switched_on()
        self.start()

    def _switched_on(self) -> Controller:
        booted_s = self._clock()
        return Controller(self._arm, self.faults, self._offer, booted_s, self._contact_closed)

    @property
    def open_channels(self) -> list[Channel]:
        """Channels that the PC has accepted."""
        return sorted(self.logic.links)

    def moving(self) -> bool:
        """The arm moves, or follows a stream."""
        return self.logic.moving(self._clock())

    # -- controller -----------------------------------------------------------------------------
    async def _run(self) -> None:
        while True:
            if self.faults.active("cut"):
                for sender in self._senders.values():
                    sender.close()
            self._post(self.logic.tick(self._clock()))
            await asyncio.sleep(_TICK_S)

    def _post(self, out: Outbox) -> None:
        for channel, record in out:
            if sender := self._senders.get(channel):
                sender.send(encode(record))

    # -- channels -------------------------------------------------------------------------------
    async def _keep_connected(self, channel: Channel) -> None:
        while True:
            if not self.faults.active("cut"):
                with suppress(OSError, TimeoutError, asyncio.IncompleteReadError, RecordError):
                    await self._connection(channel)
            await asyncio.sleep(_RETRY_S)

    async def _connection(self, channel: Channel) -> None:
        reader, writer = await asyncio.open_connection(
            self._host, self._ports[channel], limit=RECORD_MAX
        )
        try:
            connection: socket.socket = writer.get_extra_info("socket")
            # A record is smaller than a packet: Nagle would hold a STAT back until the one before
            # is acknowledged.
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            session = await self._hello(channel, reader, writer)
            await self._session(channel, session, reader, writer)
        finally:
            self._senders.pop(channel, None)
            # However it ended: the page of the protocol has the robot stop when a channel is gone.
            self.logic.closed(channel, self._clock())
            writer.close()
            with suppress(OSError):
                await writer.wait_closed()

    async def _hello(
        self, channel: Channel, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> int:
        settings, wrong = self._arm.settings, self.faults.active
        hello = [
            "HELLO",
            "SJL",
            "9" if wrong("wrong_version") else "1",
            channel,
            "NOBODY" if wrong("wrong_name") else settings.name,
            JOB_VERSION,
            "EUL=ZYZ"
            if wrong("wrong_euler")
            else f"EUL={'XYZ' if wrong('other_euler') else 'ZYX'}",
            "UNIT=MRAD" if wrong("wrong_unit") else "UNIT=MMDEG",
            f"STEPMAX={fixed(settings.step_max_mm, 4)}",
            f"DEADMAN={settings.deadman_ms}",
        ]
        if channel == "CMD" and self.logic.offer is not None:
            hello.append(self.logic.offer.option())
        writer.write(encode(hello))
        async with asyncio.timeout(_HELLO_TIMEOUT_S):
            answer = decode(await _line(reader))
        if len(answer) != 4 or answer[:3] != ["OK", "HELLO", "1"]:
            raise RecordError(f"not accepted: {answer}")
        return integer(answer[3])

    async def _session(
        self,
        channel: Channel,
        session: int,
        reader: asyncio.StreamReader,
        writer: asyncio.StreamWriter,
    ) -> None:
        sender = self._senders[channel] = Sender(writer, self.faults)
        self.logic.opened(channel, session, self._clock())
        jobs = [sender.run(), self._listen(channel, reader)]
        # CMD answers and says nothing by itself; STA and GRD report without being asked.
        if channel != "CMD":
            jobs.append(self._report(sender))
        tasks = [asyncio.ensure_future(job) for job in jobs]
        try:
            done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_EXCEPTION)
            for task in done:
                task.result()
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)

    async def _listen(self, channel: Channel, reader: asyncio.StreamReader) -> None:
        try:
            while True:
                line = await _line(reader)
                # Read and thrown away: from the side of the PC the connection still stands.
                if not self.faults.active("half_open"):
                    self._take(channel, decode(line))
        except RecordError:
            self._drop_others(channel)
            raise

    def _take(self, channel: Channel, fields: list[str]) -> None:
        if channel == "CMD":
            self._post(self.logic.command(fields, self._clock()))
        else:
            self._post(self.logic.supervise(channel, fields, self._clock()))

    def _drop_others(self, channel: Channel) -> None:
        """Drop every other channel as well: the robot does so after a protocol violation."""
        for other, sender in self._senders.items():
            if other != channel:
                sender.close()

    async def _report(self, sender: Sender) -> None:
        """STAT every 20 ms."""
        count, record, due_s = 0, b"", self._clock()
        while True:
            count += 1
            if not (record and self.faults.active("frozen_stat")):
                record = encode(self._stat(count))
            sender.send(record)
            # The next record is due a period after this one was due, or the rate would fall by what
            # sending takes; it is never sent earlier to make up for what was missed.
            due_s = max(due_s + _STAT_PERIOD_S, self._clock())
            await asyncio.sleep(max(due_s - self._clock(), 0.001))

    def _stat(self, count: int) -> list[str]:
        now_s, logic, panel = self._clock(), self.logic, self.logic.panel
        jump = self.faults.active("clock_jump")
        uptime_ms = 1000 * (now_s - logic.booted_s) + (jump.number("jump_ms", 1e6) if jump else 0)
        flags = [panel.emergency_stop, panel.drives, logic.moving(now_s), logic.latched]
        return [
            "STAT",
            str(count),
            str(round(uptime_ms)),
            panel.mode,
            *("1" if flag else "0" for flag in flags),
            str(panel.error_code),
            "0" if self.faults.active("override_zero") else "100",
            *pose_fields(self._arm.encoder_matrix(now_s)),
            *joint_fields(self._arm.joints(now_s).tolist()),
        ]


async def _line(reader: asyncio.StreamReader) -> bytes:
    try:
        return (await reader.readuntil(b"\n"))[:-1]
    except asyncio.LimitOverrunError as error:
        raise RecordError("record without an end") from error
