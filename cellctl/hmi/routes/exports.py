"""What is made of a run when somebody asks for it: the report, and the recording for viewers."""

import asyncio
import os
import sys
import tempfile
import zipfile
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Annotated, BinaryIO, Literal

from fastapi import APIRouter, Query, Request
from fastapi.responses import Response, StreamingResponse
from starlette.types import Receive, Scope, Send

from cellctl.hmi.problems import Problem
from cellctl.hmi.routes.parameters import RunNumber
from cellctl.hmi.visitors.access import Asked

router = APIRouter(tags=["records"])
REPORT_S = 60.0
RECORDING_S = 180.0
"""Most that each takes: some ten times what it takes on a PC that has little else to do."""
AT_ONCE = 2
"""Exports of all visitors together. Each fills a processor for seconds, and the recording of a run
takes some hundred MB of the disk until it is sent; the cell is not to wait for either."""
_PIECE_BYTES = 2**18


Images = Annotated[
    Literal["lossless", "jpeg", "none"],
    Query(description="What becomes of the raw images, in the words of `cellctl runs export`."),
]


class RunExporter:
    """Has `cellctl runs export` make files in processes of their own.

    They draw and compress, and the page would stand still meanwhile.
    """

    def __init__(self, data_dir: Path, at_once: int = AT_ONCE) -> None:
        self._data_dir, self._at_once = data_dir, at_once
        self._running = 0

    @asynccontextmanager
    async def made(
        self, number: int, form: tuple[str, ...], name: str, limit_s: float
    ) -> AsyncIterator[Path]:
        """The folder with what was made, which is gone afterwards; ``name`` is that of ``--out``.

        Raises ``Problem``: 429 while others export, 504 after ``limit_s``, 500 with the words of
        the command.
        """
        if self._running >= self._at_once:
            raise Problem(429, "busy", "other exports are under way; try again soon").later(5.0)
        self._running += 1
        try:
            with tempfile.TemporaryDirectory(prefix="cellctl-export-") as folder:
                out = Path(folder) / name
                await self._run(str(number), *form, "--out", str(out), limit_s=limit_s)
                yield Path(folder)
        finally:
            self._running -= 1

    async def _run(self, *arguments: str, limit_s: float) -> None:
        process = await asyncio.create_subprocess_exec(
            sys.executable, "-P", "-m", "cellctl", "runs", "export", *arguments,
            "--data-dir", str(self._data_dir),
            stdout=asyncio.subprocess.DEVNULL, stderr=asyncio.subprocess.PIPE,
        )  # fmt: skip
        try:
            async with asyncio.timeout(limit_s):
                _, complaint = await process.communicate()
        except TimeoutError:
            raise Problem(504, "export", f"the export takes more than {limit_s:g} s") from None
        finally:
            if process.returncode is None:
                process.kill()
                await process.wait()
        if process.returncode:
            words = complaint.decode(errors="replace").strip().splitlines() or [""]
            raise Problem(500, "export", words[0])


@router.get("/runs/{number}/report", response_class=Response)
async def report(request: Request, number: RunNumber, _visitor: Asked) -> Response:
    """The report as one file to keep, made now; a page of its own, not a part of this one."""
    exporter = await _exporter(request, number)
    async with exporter.made(number, ("--single-file",), "report", REPORT_S) as folder:
        data = (folder / "report" / "report.html").read_bytes()
    headers = {"Content-Disposition": f'attachment; filename="run-{number}.html"'}
    return Response(data, media_type="text/html", headers=headers)


@router.get("/runs/{number}/recording", response_class=StreamingResponse)
async def recording(
    request: Request, number: RunNumber, _visitor: Asked, images: Images = "jpeg"
) -> Response:
    """The whole run as one MCAP file for Foxglove, made now; ``images=lossless`` is much larger."""
    exporter = await _exporter(request, number)
    name = f"run-{number}.mcap"
    form = ("--mcap", "--images", images)
    async with exporter.made(number, form, name, RECORDING_S) as folder:
        return FileToKeep(folder / name, name, "application/octet-stream")


@router.get("/runs/{number}/record.zip", response_class=StreamingResponse)
async def record(request: Request, number: RunNumber, _visitor: Asked) -> Response:
    """The whole record to keep, made now: `run.json`, the report, and every file of the run."""
    exporter = await _exporter(request, number)
    async with exporter.made(number, (), "record", REPORT_S) as folder:
        packed = folder / "record.zip"
        await asyncio.to_thread(_pack, folder / "record", packed)
        return FileToKeep(packed, f"run-{number}.zip", "application/zip")


def _pack(folder: Path, packed: Path) -> None:
    # Stored as they are: pictures and recordings are compressed already.
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_STORED) as archive:
        for file in sorted(folder.rglob("*")):
            if file.is_file():
                archive.write(file, file.relative_to(folder))


class FileToKeep(StreamingResponse):
    """A file to be saved by whoever asks; open from now on, so that its folder may go."""

    def __init__(self, path: Path, name: str, media_type: str) -> None:
        self._file = path.open("rb")
        headers = {
            "Content-Disposition": f'attachment; filename="{name}"',
            "Content-Length": str(os.fstat(self._file.fileno()).st_size),
        }
        super().__init__(_pieces(self._file), media_type=media_type, headers=headers)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send it."""
        try:
            await super().__call__(scope, receive, send)
        finally:
            # Also when whoever asked has gone before the first piece, of which nothing else is
            # told.
            self._file.close()


def _pieces(file: BinaryIO) -> Iterator[bytes]:
    # In memory as a whole it would be as large as the page's process.
    while piece := file.read(_PIECE_BYTES):
        yield piece


async def _exporter(request: Request, number: int) -> RunExporter:
    parts = request.app.state.parts
    # Asked first, so that a number that does not exist is 404 and costs no process.
    await parts.archive.run(number)
    exporter: RunExporter = parts.exporter
    return exporter
