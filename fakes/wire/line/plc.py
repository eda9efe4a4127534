"""A line PLC that has one part assembled, or one procedure run: ``python -m fakes plc``.

Prints a line of JSON for every change and a last one with the result. Exit codes: 0 good, 2 bad,
3 refused, 4 stopped, aborted or held, 5 time-out, 6 cell lost, 7 wrong register map.
"""

import asyncio
import json
import logging
import sys
import time
from dataclasses import asdict, dataclass, field, replace
from typing import Annotated

import typer

from fakes.wire.line.link import CellLink, CellLost
from fakes.wire.line.register_map import (
    CLEAR,
    MODES,
    RESET,
    START,
    STOP,
    MapMismatch,
    Report,
    command_block,
)

EXIT_CODES = {"good": 0, "bad": 2, "rejected": 3, "stopped": 4, "aborted": 4, "held": 4}
TIMEOUT, LOST, MISMATCH = 5, 6, 7
STEP_TIMEOUT_S = 60.0
"""Longest wait for one state on the way to Idle: far above any Clear or Reset."""
_WAYS_TO_IDLE = {"ABORTED": CLEAR, "STOPPED": RESET, "COMPLETED": RESET}
_QUIET = frozenset({"cell_heartbeat", "force_z_n"})
"""Change all the time; printed with whatever else changes, or twice a second."""

app = typer.Typer(add_completion=False)


@dataclass(slots=True)
class Printer:
    """Prints reports that differ from the one before."""

    _last: dict[str, object] = field(default_factory=dict)
    _time_s: float = 0.0

    def report(self, report: Report) -> None:
        """Print when something changed."""
        values = asdict(report)
        changed = {name for name, value in values.items() if self._last.get(name) != value}
        now_s = time.monotonic()
        if changed - _QUIET or ("force_z_n" in changed and now_s - self._time_s > 0.5):
            emit("report", **values)
            self._last, self._time_s = values, now_s


def emit(event: str, **values: object) -> None:
    """One line of JSON on standard output."""
    sys.stdout.write(json.dumps({"event": event, "time": round(time.time(), 3), **values}) + "\n")
    sys.stdout.flush()


class Line:
    """The PLC's program: bring the cell to Idle, start, wait for the end."""

    def __init__(self, link: CellLink) -> None:
        self._link = link
        self._seq = 0

    async def assemble(
        self, *, mode: int, recipe: int, serial: str, mate_serial: str = "", timeout_s: float
    ) -> Report:
        """Run one job; the report in which it has ended. Held counts as its end: Stop follows."""
        await self.to_idle()
        seq, taken = await self.command(
            START, mode=mode, recipe=recipe, serial=serial, mate_serial=mate_serial
        )
        if taken.result == "rejected":
            return taken
        try:
            report = await self._link.until(
                lambda r: r.done_seq == seq or r.state == "HELD", timeout_s
            )
        except TimeoutError:
            await self.command(STOP)
            raise
        if report.state == "HELD":
            emit("held", alarms=report.alarms)
            await self.command(STOP)
            stopped = await self._link.until(lambda r: r.state in _WAYS_TO_IDLE, STEP_TIMEOUT_S)
            return replace(stopped, result="held", first_out_alarm=report.first_out_alarm)
        return report

    async def to_idle(self) -> None:
        """Clear and Reset as needed."""
        while True:
            report = await self._link.until(
                lambda r: r.state in _WAYS_TO_IDLE or r.state in ("IDLE", "EXECUTE", "HELD"),
                STEP_TIMEOUT_S,
            )
            if report.state == "IDLE":
                return
            # Somebody else has started that job, and it is not ours to stop.
            if report.state == "EXECUTE":
                raise CellRefused(report, "the cell works on another part")
            seq, taken = await self.command(_WAYS_TO_IDLE.get(report.state, STOP))
            if taken.result == "rejected":
                raise CellRefused(taken, f"refused with 0x{taken.reject_code:X}")
            ended = await self._link.until(lambda r, seq=seq: r.done_seq == seq, STEP_TIMEOUT_S)  # type: ignore[misc]
            if ended.result in ("stopped", "aborted") and ended.first_out_alarm:
                raise CellRefused(ended, f"alarm {ended.first_out_alarm}")

    async def command(
        self,
        command: int,
        *,
        mode: int = 0,
        recipe: int = 0,
        serial: str = "",
        mate_serial: str = "",
    ) -> tuple[int, Report]:
        """Commit a command and wait until it is acknowledged; its number and that report.

        The cell ignores the first number after its own start; the next one counts.
        """
        while True:
            before = await self._link.until(lambda _report: True, STEP_TIMEOUT_S)
            # Numbers go round without 0, which says that no command was given yet.
            self._seq = seq = max(before.ack_seq, self._seq) % 0xFFFF + 1
            if before.ack_seq == 0:
                self._seq = seq = 1
            block = command_block(
                seq, command, mode=mode, recipe=recipe, serial=serial, mate_serial=mate_serial
            )
            await self._link.write(0, block)
            report = await self._link.until(lambda r, seq=seq: r.ack_seq == seq, STEP_TIMEOUT_S)  # type: ignore[misc]
            if not (report.result == "ignored" and report.done_seq == seq):
                return seq, report


class CellRefused(RuntimeError):
    """The cell cannot be brought to Idle."""

    def __init__(self, report: Report, message: str) -> None:
        super().__init__(message)
        self.report = report


@app.command()
def run(  # noqa: PLR0917  # options of the command line
    serial: Annotated[str, typer.Option(help="Serial number of the part.")] = "SAT-0001",
    mate_serial: Annotated[
        str, typer.Option(help="Serial number of the part it is joined to.")
    ] = "",
    mode: Annotated[str, typer.Option(help="production or maintenance.")] = "production",
    recipe: Annotated[int, typer.Option(help="Recipe, or procedure in maintenance.")] = 1,
    host: str = "127.0.0.1",
    port: int = 5020,
    timeout: Annotated[float, typer.Option(help="Seconds for the whole job.")] = 300.0,
    connect_timeout: Annotated[float, typer.Option(help="Seconds to wait for the cell.")] = 30.0,
) -> None:
    """Have one part assembled or one procedure run."""
    if mode not in MODES:
        raise typer.BadParameter(f"mode is one of {', '.join(MODES)}")
    logging.getLogger("pymodbus.logging").setLevel(logging.CRITICAL)
    job = {
        "mode": MODES[mode],
        "recipe": recipe,
        "serial": serial,
        "mate_serial": mate_serial,
        "timeout_s": timeout,
    }
    try:
        code = asyncio.run(play(host, port, job, connect_timeout))
    except KeyboardInterrupt:
        code = 130
    raise typer.Exit(code)


async def play(host: str, port: int, job: dict[str, object], connect_timeout_s: float) -> int:
    """Connect, run one job, print the result; the exit code."""
    try:
        link = await CellLink.open(host, port, Printer().report, connect_timeout_s)
        work = asyncio.create_task(Line(link).assemble(**job))  # type: ignore[arg-type]
        watch = asyncio.create_task(link.run())
        try:
            await asyncio.wait({work, watch}, return_when=asyncio.FIRST_COMPLETED)
            if not work.done():
                # The link has ended before the job: its error is what happened.
                watch.result()
            report = work.result()
        finally:
            link.end()
            for task in (work, watch):
                task.cancel()
            await asyncio.gather(work, watch, return_exceptions=True)
            link.client.close()
    except CellRefused as error:
        return _finish(error.report, "rejected", str(error))
    except TimeoutError:
        return _fail("timeout", "the job did not end in time", TIMEOUT)
    except (CellLost, MapMismatch, ExceptionGroup) as error:
        return _classify(error)
    return _finish(report, report.result, "")


def _classify(error: Exception) -> int:
    if isinstance(error, ExceptionGroup):
        return _classify(error.exceptions[0])
    return _fail("lost", str(error), MISMATCH if isinstance(error, MapMismatch) else LOST)


def _finish(report: Report, result: str, message: str) -> int:
    emit(
        "result",
        result=result,
        run=report.run,
        serial=report.serial,
        reject_code=report.reject_code,
        alarm=report.first_out_alarm,
        error_mm=report.error_mm,
        error_deg=report.error_deg,
        force_peaks=report.force_peaks,
        message=message,
    )
    return EXIT_CODES.get(result, EXIT_CODES["aborted"])


def _fail(result: str, message: str, code: int) -> int:
    emit("result", result=result, message=message)
    return code
