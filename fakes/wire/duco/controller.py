"""A controller of a collaborative arm on the wire: the service, and the state stream."""

import asyncio
import socket
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from thrift.Thrift import TType

from fakes.wire.duco import frame
from fakes.wire.duco.codec import CallError, Fields, read_call, write_reply, write_unknown
from fakes.wire.duco.logic import Client, DucoLogic

_TICK_S = 0.004
"""How often heartbeats, safety and the end of a motion are looked at."""
_MOTIONS = {"movej", "movel", "servoj_pose"}


class DucoController:
    """``start`` listens on two free ports, or on given ones; ``stop`` hangs up."""

    def __init__(self, logic: DucoLogic, *, rpc_port: int = 0, state_port: int = 0) -> None:
        self.logic = logic
        self.rpc_port = rpc_port
        self.state_port = state_port
        self._servers: list[asyncio.Server] = []
        self._tasks: set[asyncio.Task[None]] = set()
        self._writers: set[asyncio.StreamWriter] = set()
        self._clients = 0

    async def start(self) -> None:
        """Listen on both ports."""
        rpc = await asyncio.start_server(self._accept(self._serve), "127.0.0.1", self.rpc_port)
        state = await asyncio.start_server(self._accept(self._report), "127.0.0.1", self.state_port)
        self._servers = [rpc, state]
        self.rpc_port, self.state_port = (
            int(server.sockets[0].getsockname()[1]) for server in self._servers
        )
        self._begin(self._run())

    async def stop(self) -> None:
        """Hang up. Idempotent."""
        for server in self._servers:
            server.close()
        tasks, self._tasks = self._tasks, set()
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    def _begin(self, job: Any) -> None:
        task = asyncio.ensure_future(job)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _run(self) -> None:
        while True:
            if self.logic.faults.active("cut"):
                for writer in self._writers:
                    # A line that is cut loses what is still in the buffer; closing would send it.
                    writer.transport.abort()
            self.logic.tick()
            await asyncio.sleep(_TICK_S)

    def _accept(self, serve: Any) -> Any:
        def accepted(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            self._begin(self._connection(serve, reader, writer))

        return accepted

    async def _connection(
        self, serve: Any, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> None:
        connection: socket.socket = writer.get_extra_info("socket")
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._writers.add(writer)
        try:
            with suppress(ConnectionError, CallError):
                await serve(reader, writer)
        finally:
            self._writers.discard(writer)
            writer.close()
            with suppress(ConnectionError):
                await writer.wait_closed()

    # -- state stream ---------------------------------------------------------------------------
    async def _report(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        wrong = self.logic.faults.active
        if wrong("misaligned"):
            # A reader that does not look for the beginning of a frame is out of step from here on.
            writer.write(frame.pack(self.logic)[700:])
        while not reader.at_eof():
            if not (wrong("silent") or wrong("frames_stop")):
                writer.write(frame.pack(self.logic))
                await writer.drain()
            with suppress(TimeoutError):
                # Sleeps for a period, and wakes at once when the client hangs up.
                await asyncio.wait_for(reader.read(1), frame.PERIOD_S)

    # -- service --------------------------------------------------------------------------------
    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._clients += 1
        client, buffer = self._clients, b""
        while data := await reader.read(4096):
            buffer += data
            while (call := read_call(buffer)) is not None:
                name, arguments, length = call
                buffer = buffer[length:]
                answer = await self._answer(client, name, arguments)
                if not answer:
                    # Calls of one connection are worked on in their order, so that nothing behind
                    # one that hangs is heard either.
                    await _swallow(reader)
                    return
                if not self.logic.faults.active("silent"):
                    writer.write(answer)

    async def _answer(self, client: Client, name: str, arguments: Fields) -> bytes:
        if name in _MOTIONS or name == "stop":
            return await self._motion(name, arguments)
        unknown = self.logic.faults.active("unknown")
        if unknown and name == unknown.text("call", "get_robot_version"):
            return write_unknown(name)
        return self._question(client, name, arguments)

    async def _motion(self, name: str, of: Fields) -> bytes:
        logic, blocking = self.logic, False
        if name != "stop" and (late := logic.faults.use("motion_late")):
            await asyncio.sleep(late.number("delay_s", 0.5))
        if name == "stop":
            number, blocking = logic.stop(), of[1]
        elif name == "movej":
            number, blocking = logic.move_joint(of[1], of[2]), of[5]
        elif name == "movel":
            number, blocking = logic.move_linear(of[1], of[2], of[3], (of[6], of[7])), of[8]
        else:
            number, blocking = logic.servo(of[1], (of[5], of[6])), of[7]
            if late := logic.faults.use("servo_late"):
                await asyncio.sleep(late.number("delay_s", 0.03))
        if blocking:
            while logic.moving():  # noqa: ASYNC110 - the arm tells nobody
                await asyncio.sleep(_TICK_S)
            logic.tick()  # so that the task of an arm that stands has ended
            number = logic.tasks.state(number)
        if name != "stop" and logic.faults.active("motion_silent"):
            return b""
        return write_reply(name, TType.I32, number)

    def _question(self, client: Client, name: str, of: Fields) -> bytes:
        logic = self.logic

        def heartbeat() -> None:
            logic.heartbeat(client, of[1])

        def task_state() -> int:
            logic.tick()
            return logic.tasks.state(of[1])

        def pose() -> list[float]:
            return logic.pose() if logic.frame_known(of[1], of[2]) else []

        def write_word() -> int:
            logic.words[of[1]] = of[2]
            return 0

        answers: dict[str, tuple[Callable[[], Any], int, int]] = {
            "rpc_heartbeat": (heartbeat, TType.VOID, TType.STOP),
            "get_noneblock_taskstate": (task_state, TType.I32, TType.STOP),
            "robotmoving": (logic.moving, TType.BOOL, TType.STOP),
            "get_robot_state": (logic.states, TType.LIST, TType.BYTE),
            "get_robot_version": (lambda: logic.version, TType.STRING, TType.STOP),
            "get_tcp_pose_coord": (pose, TType.LIST, TType.DOUBLE),
            "get_actual_joints_position": (logic.joints, TType.LIST, TType.DOUBLE),
            "get_tool_load": (lambda: logic.tool_load, TType.LIST, TType.DOUBLE),
            "get_tcp_offset": (lambda: logic.tool_frame, TType.LIST, TType.DOUBLE),
            "get_wobj": (lambda: logic.work_object, TType.LIST, TType.DOUBLE),
            "set_load_data": (lambda: logic.set_load(of[1]), TType.I32, TType.STOP),
            "get_last_error": (lambda: logic.errors, TType.LIST, TType.STRING),
            "read_word_reg": (lambda: logic.words[of[1]], TType.I32, TType.STOP),
            "write_word_reg": (write_word, TType.I32, TType.STOP),
        }
        if name not in answers:
            return write_unknown(name)
        answer, kind, element = answers[name]
        return write_reply(name, kind, answer(), element)


async def _swallow(reader: asyncio.StreamReader) -> None:
    while await reader.read(4096):
        pass
