"""The PC of a tracker (a large-field head) on the wire: TGT/1 (docs/protocols/target-server.md)."""

import asyncio
import json
from collections.abc import Awaitable, Callable
from contextlib import suppress
from typing import Any

from fakes.faults import TRACKER_FAULTS, FaultBoard
from fakes.world.frames import MM
from fakes.world.targets import SeenTarget

# docs/protocols/target-server.md.
_LINE_MAX = 65_536
_FRAMES_MAX = 200


class TargetServer:
    """Serves one client at a time; ``measure`` gives the targets of the world."""

    def __init__(
        self,
        measure: Callable[[int], Awaitable[tuple[SeenTarget, ...]]],
        *,
        serial: str = "ET-0001",
        faults: FaultBoard | None = None,
    ) -> None:
        self.faults = faults or FaultBoard("tracker", TRACKER_FAULTS)
        self._measure = measure
        self._serial = serial
        self._server: asyncio.Server | None = None
        self._client: asyncio.StreamWriter | None = None

    async def start(self, host: str = "127.0.0.1", port: int = 0) -> int:
        """Listen; returns the port."""
        self._server = await asyncio.start_server(self._serve, host, port, limit=_LINE_MAX)
        return int(self._server.sockets[0].getsockname()[1])

    async def stop(self) -> None:
        """Stop listening and hang up. Idempotent."""
        server, self._server = self._server, None
        if self._client is not None:
            self._client.close()
        if server is not None:
            server.close()
            await server.wait_closed()

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        if self._client is not None:
            writer.close()
            return
        self._client = writer
        try:
            while line := await reader.readline():
                reply = await self._answer(line)
                if reply is not None:
                    writer.write(reply)
                    await writer.drain()
        except (ConnectionError, ValueError):
            pass  # the client has gone, or sent a line without an end: hang up
        finally:
            self._client = None
            writer.close()
            with suppress(OSError):
                await writer.wait_closed()

    async def _answer(self, line: bytes) -> bytes | None:
        if self.faults.use("silent"):
            return None
        try:
            request = json.loads(line)
            reply = {"id": request["id"], **await self._execute(request)}
        except (ValueError, KeyError, TypeError) as error:
            reply = {"id": None, "status": "error", "message": f"bad request: {error}"}
        if self.faults.use("wrong_id"):
            reply["id"] = 999_999
        text = json.dumps(reply)
        if self.faults.use("malformed"):
            text = text[: len(text) // 2]
        return text.encode() + b"\n"

    async def _execute(self, request: dict[str, Any]) -> dict[str, Any]:
        if self.faults.use("error"):
            return {"status": "error", "message": "camera fault"}
        if request["cmd"] == "identify":
            identity = {"model": "E-Track", "serial": self._serial, "firmware": "1.0"}
            return {"status": "ok", **identity}
        if request["cmd"] != "measure":
            return {"status": "error", "message": f"unknown command {request['cmd']!r}"}
        frames = request.get("frames", 1)
        if not isinstance(frames, int) or not 1 <= frames <= _FRAMES_MAX:
            return {"status": "error", "message": f"frames must be 1 to {_FRAMES_MAX}"}
        hidden = self.faults.active("hidden")
        skip = hidden.text("name", "F1") if hidden else None
        seen = [target for target in await self._measure(frames) if target.name != skip]
        return {"status": "ok", "targets": [_target(target) for target in seen]}


def _target(target: SeenTarget) -> dict[str, Any]:
    return {
        "name": target.name,
        "xyz_mm": [round(float(value) / MM, 5) for value in target.position_m],
        "sigma_mm": round(target.sigma_m / MM, 5),
    }
