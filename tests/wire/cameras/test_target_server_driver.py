"""The target-server driver against scripted servers; lines from docs/protocols/target-server.md."""

import asyncio
import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cellctl.errors.base import CellError
from cellctl.errors.link import (
    ConnectTimeout,
    DeviceFault,
    LinkLost,
    ProtocolViolation,
    ReplyTimeout,
)
from drivers.camera.target_server import protocol
from drivers.camera.target_server.config import TargetServerConfig
from drivers.camera.target_server.driver import TargetServerTracker
from tests.rigs.wire.ports import free_ports
from tests.wire.scripted_server import Script, serving

IDENTITY = (
    b'{"id": %d, "status": "ok", "model": "E-Track", "serial": "ET-0001", "firmware": "1.0"}\n'
)
TARGETS = (
    b'{"id": %d, "status": "ok", "targets": '
    b'[{"name": "F1", "xyz_mm": [12.3456, 0.0, 5986.16], "sigma_mm": 0.03}]}\n'
)


class Server:
    """Answers with the lines of the document, until ``script`` decides otherwise."""

    def __init__(self) -> None:
        self.requests: list[dict[str, object]] = []
        self.script: Script = self.answer

    def __call__(self, request: bytes) -> bytes | None:
        self.requests.append(json.loads(request))
        return self.script(request)

    def answer(self, request: bytes) -> bytes:
        asked = json.loads(request)
        template = IDENTITY if asked["cmd"] == "identify" else TARGETS
        return template.replace(b"%d", str(asked["id"]).encode())


async def read_request(reader: asyncio.StreamReader) -> bytes:
    return await reader.readuntil(b"\n")


def tracker(port: int) -> TargetServerTracker:
    settings = TargetServerConfig(
        host="127.0.0.1", port=port, reply_timeout_s=0.3, frame_timeout_s=0.0
    )
    return TargetServerTracker("large_field", settings)


async def test_measure() -> None:
    server = Server()
    async with serving(read_request, server) as port, tracker(port) as device:
        assert await device.serial_number() == "ET-0001"
        (target,) = await device.measure(10)
        assert server.requests[0] == {"id": 1, "cmd": "identify"}
        assert server.requests[2] == {"id": 3, "cmd": "measure", "frames": 10}
        assert target.name == "F1"
        assert target.position_m == pytest.approx([0.0123456, 0.0, 5.98616])
        assert target.sigma_m == pytest.approx(0.00003)


async def test_a_split_reply_is_one_reply() -> None:
    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while line := await reader.readline():
            for byte in Server().answer(line):
                writer.write(bytes([byte]))
                await writer.drain()
        writer.close()

    server = await asyncio.start_server(serve, "127.0.0.1", 0)
    async with server, tracker(server.sockets[0].getsockname()[1]) as device:
        assert len(await device.measure()) == 1


@pytest.mark.parametrize(
    "line",
    [
        b"\n",
        b"nonsense\n",
        b"[1, 2]\n",
        b'{"id": 99, "status": "ok", "targets": []}\n',
        b'{"id": 2.0, "status": "ok", "targets": []}\n',
        b'{"id": 2, "status": "fine", "targets": []}\n',
        b'{"id": 2, "status": "ok"}\n',
        b'{"id": 2, "status": "ok", "targets": [1]}\n',
        b'{"id": 2, "status": "ok", "targets": [{"name": "F1"}]}\n',
        b'{"id": 2, "status": "ok", "targets": '
        b'[{"name": "F1", "xyz_mm": [1, 2], "sigma_mm": 1}]}\n',
        b'{"id": 2, "status": "ok", "targets": '
        b'[{"name": "F1", "xyz_mm": [1, 2, NaN], "sigma_mm": 1}]}\n',
        b'{"id": 2, "status": "ok", "targets": '
        b'[{"name": "F1", "xyz_mm": [1, 2, true], "sigma_mm": 1}]}\n',
        b'{"id": 2, "status": "ok", "targets": '
        b'[{"name": "F1", "xyz_mm": [1, 2, 3], "sigma_mm": 0}]}\n',
        b'{"id": 2, "status": "ok", "targets": ['
        b'{"name": "F1", "xyz_mm": [1, 2, 3], "sigma_mm": 1},'
        b'{"name": "F1", "xyz_mm": [1, 2, 3], "sigma_mm": 1}]}\n',
        b"x" * 70_000 + b"\n",
        b"\xff\xfe\n",
        b"[" * 60_000 + b"\n",
    ],
)
async def test_invalid_replies(line: bytes) -> None:
    server = Server()
    async with serving(read_request, server) as port, tracker(port) as device:
        server.script = lambda request: line
        with pytest.raises(ProtocolViolation):
            await device.measure()
        server.script = server.answer
        assert len(await device.measure()) == 1


async def test_error_of_the_server() -> None:
    server = Server()
    async with serving(read_request, server) as port, tracker(port) as device:
        server.script = lambda request: b'{"id": 2, "status": "error", "message": "too warm"}\n'
        with pytest.raises(DeviceFault, match="too warm"):
            await device.measure()


@pytest.mark.parametrize(
    ("reply", "fault"),
    [(None, LinkLost), (b"", ReplyTimeout)],
    ids=["an unexpected close", "silence"],
)
async def test_one_request_fails_and_the_next_gets_its_own_reply(
    reply: bytes | None, fault: type[CellError]
) -> None:
    server = Server()
    async with serving(read_request, server) as port, tracker(port) as device:
        server.script = lambda request: reply
        with pytest.raises(fault):
            await device.measure()
        server.script = server.answer
        assert len(await device.measure()) == 1


@pytest.mark.parametrize("frames", [0, 201])
async def test_number_of_frames(frames: int) -> None:
    server = Server()
    async with serving(read_request, server) as port, tracker(port) as device:
        with pytest.raises(ValueError, match="frames"):
            await device.measure(frames)
        assert [r["cmd"] for r in server.requests] == ["identify"]


async def test_nobody_listens() -> None:
    with pytest.raises(ConnectTimeout):
        await tracker(free_ports(1)[0]).connect()


async def test_not_connected() -> None:
    with pytest.raises(LinkLost):
        await tracker(9).measure()


@given(st.binary(max_size=200))
def test_noise_is_a_violation(line: bytes) -> None:
    with pytest.raises(ProtocolViolation):
        protocol.parse_targets(line, 1)


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text("F1xé", max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.just("k"), inner),
    max_leaves=8,
)


@given(st.dictionaries(st.sampled_from(["name", "xyz_mm", "sigma_mm"]), json_values))
def test_any_target_is_valid_or_a_violation(entry: dict[str, object]) -> None:
    line = json.dumps({"id": 1, "status": "ok", "targets": [entry]}).encode()
    try:
        (target,) = protocol.parse_targets(line, 1)
    except ProtocolViolation:
        return
    assert target.sigma_m > 0
    assert abs(target.position_m).max() < 1e3
