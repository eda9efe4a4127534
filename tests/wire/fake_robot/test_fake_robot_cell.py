"""The fake cell as a process: ready line, control port, target server, clean end."""

import asyncio
import json
import signal
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from fakes.__main__ import app

ROBOT_PORTS = [
    f"{robot}.{channel}" for robot in ("main", "aux_1", "aux_2") for channel in ("CMD", "STA")
]
FREE = ["main.GRD", "force", "control", "tracker", "head_1", "head_2"]
START_S = 120
"""Only a program that never starts takes so long: beside other tests it loads its libraries for
half a minute."""


@asynccontextmanager
async def running(
    *overrides: str,
) -> AsyncIterator[tuple[asyncio.subprocess.Process, dict[str, Any]]]:
    """Port 1 is closed: the robots look for their PC in vain."""
    ports = [f"{name}=1" for name in [*ROBOT_PORTS, "main.GRD"]]
    ports += [f"{name}=0" for name in FREE[1:]]
    options = [item for port in [*ports, *overrides] for item in ("--port", port)]
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-m", "fakes", "run", "--seed", "5", *options,
        stdout=asyncio.subprocess.PIPE,
    )  # fmt: skip
    assert process.stdout is not None
    try:
        line = await asyncio.wait_for(process.stdout.readline(), START_S)
        yield process, json.loads(line)
    finally:
        if process.returncode is None:
            process.send_signal(signal.SIGTERM)
        await asyncio.wait_for(process.wait(), 15)


async def ask(port: int, **request: Any) -> dict[str, Any]:
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(json.dumps({"id": 7, **request}).encode() + b"\n")
    reply: dict[str, Any] = json.loads(await asyncio.wait_for(reader.readline(), 10))
    writer.close()
    await writer.wait_closed()
    assert reply["id"] == 7
    return reply


async def test_cell_from_start_to_end() -> None:
    async with running() as (process, ready):
        assert ready["ready"] is True
        ports = ready["ports"]
        control = ports["control"]
        truth = (await ask(control, cmd="truth"))["truth"]
        assert truth["seed"] == 5
        assert set(truth["pins"]) == {"P1", "P5"}
        await ask(control, cmd="load")
        again = (await ask(control, cmd="truth"))["truth"]
        assert again["base_T_frame_mm_deg"] != truth["base_T_frame_mm_deg"]

        seen = await ask(ports["tracker"], cmd="measure", frames=2)
        assert [target["name"] for target in seen["targets"]] == [f"F{n}" for n in range(1, 7)]
        await ask(control, cmd="place_target_board", head="head_1")
        seen = await ask(ports["tracker"], cmd="measure", frames=2)
        assert len(seen["targets"]) == 15
        await ask(control, cmd="inject", device="tracker", name="error", count=1)
        assert (await ask(ports["tracker"], cmd="identify"))["status"] == "error"
        assert (await ask(ports["tracker"], cmd="identify"))["serial"] == "ET-0001"

        for bad in (
            {"cmd": "dance"},
            {"cmd": "place_chessboard", "head": "head_9"},
            {"cmd": "inject", "device": "toaster", "name": "silent"},
            {"cmd": "inject", "device": "main", "name": "gremlins"},
            {"cmd": "truth", "colour": "blue"},
        ):
            reply = await ask(control, **bad)
            assert reply["status"] == "error"
            assert reply["message"]
        assert (await ask(control, cmd="status"))["channels"]["main"] == []
    assert process.returncode == 0


async def test_hands_of_an_operator_from_a_terminal() -> None:
    """What docs/commissioning.md says before a procedure on a cell that stays up."""
    async with running() as (process, ready):
        port = ("--port", str(ready["ports"]["control"]))

        async def hands(*words: str) -> Result:
            return await asyncio.to_thread(CliRunner().invoke, app, ["operator", *words, *port])

        assert (await hands("present", "frame=false", "deck=false")).exit_code == 0
        truth = json.loads((await hands("truth")).stdout)["truth"]
        assert "base_T_frame_mm_deg" in truth
        assert "base_T_deck_mm_deg" not in truth
        assert (await hands("place_target_board", "head=head_1")).exit_code == 0
        for words in (("dance",), ("place_target_board", "head=head_9")):
            refused = await hands(*words)
            assert refused.exit_code == 1
            assert "fake cell refused" in refused.stderr
        assert (await hands("present", "frame")).exit_code == 2
        assert (await ask(ready["ports"]["control"], cmd="shutdown"))["status"] == "ok"
        assert await asyncio.wait_for(process.wait(), 15) == 0
    gone = await hands("status")
    assert gone.exit_code == 1
    assert "no fake cell listens on port" in gone.stderr


@pytest.mark.figures  # a program that only ends
async def test_taken_port_is_said_and_ends_with_an_error() -> None:
    server = await asyncio.start_server(lambda _reader, writer: writer.close(), "127.0.0.1", 0)
    port = server.sockets[0].getsockname()[1]
    async with running(f"control={port}") as (process, ready):
        assert ready["ready"] is False
        assert str(port) in ready["error"]
        assert await asyncio.wait_for(process.wait(), 15) == 1
    server.close()
    await server.wait_closed()


@pytest.mark.parametrize(
    "line", [b"not json\n", b"[1]\n", b'{"id": 1}\n', b'{"id": 1, "cmd": "measure", "frames": 0}\n']
)
async def test_target_server_answers_nonsense_with_an_error(line: bytes) -> None:
    from fakes.wire.cameras.target_server import TargetServer

    async def measure(frames: int) -> tuple[()]:
        return ()

    server = TargetServer(measure)
    port = await server.start()
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(line)
    assert json.loads(await asyncio.wait_for(reader.readline(), 5))["status"] == "error"
    writer.close()
    await writer.wait_closed()
    await server.stop()
