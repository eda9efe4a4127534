"""The fake line PLC, a program of its own, against the daemon's port and state machine."""

import asyncio
import json
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest

from cellctl.api.modbus.heartbeat import LineHeartbeat
from cellctl.api.modbus.interface import PlcInterface
from cellctl.command.submission import Submission
from cellctl.command.tracker import CommandTracker
from cellctl.config.cell import Plc
from cellctl.errors.base import CellError, Reaction
from cellctl.packml import PackMLMachine, RejectCode, State
from cellctl.packml.result import Result
from cellctl.packml.unit_command import UnitCommand
from cellctl.runtime.cell_status import CellStatus
from fakes.wire.line.link import CellLink

ROOT = Path(__file__).parents[3]
Action = Callable[[], Awaitable[None]]


class HoldError(CellError):
    number = 499
    reaction = Reaction.HOLD


class FakelessCell:
    """The line's half of a daemon: machine, port, heartbeat; Execute is given."""

    def __init__(self, execute: Action, result: Result, initial: State = State.ABORTED) -> None:
        self.machine = PackMLMachine({State.EXECUTE: execute}, initial=initial)
        self.commands: list[UnitCommand] = []
        heartbeat = LineHeartbeat(Plc().heartbeat_timeout_s, lambda: None)
        self.port = PlcInterface(
            Plc(port=0),
            self.submit,
            heartbeat,
            self.remember,
            note_refusal=lambda *_: None,
            previous_seq=1,
        )
        self.tracker = CommandTracker(self.machine, lambda: result)
        self.machine.on_change.append(lambda _before, _after: self.publish())
        self.status = CellStatus()
        self.beat: asyncio.Task[None] | None = None

    async def submit(self, submission: Submission) -> RejectCode:
        """Submit as the arbiter does, with checks that refuse only what a dead line may not do."""
        if not submission.command.ends_motion:
            code = submission.link_fault()
            if code is not RejectCode.NONE:
                return code
        self.commands.append(submission.command)
        return await self.tracker.execute(submission)

    async def remember(self, seq: int) -> None:
        """The number is on the disk."""

    def publish(self) -> None:
        machine = self.machine
        fault = machine.fault.number if machine.fault else 0
        self.port.publish(
            CellStatus(
                state=machine.state,
                state_requested=machine.state_requested,
                mode=machine.mode,
                step=40,
                iteration=2,
                error_mm_deg=(0.01, -0.02, 0.03, 0.001, -0.002, 0.003),
                first_out_alarm=fault,
                alarms=(fault,) if fault else (),
                run_number=7,
                serial="SAT-0042",
            )
        )

    async def start(self) -> None:
        await self.port.start()
        self.publish()
        self.beat = asyncio.create_task(self.machine.beat_while_alive(self.port.beat, 0.05))

    async def stop(self) -> None:
        if self.beat is not None:
            self.beat.cancel()
        await self.machine.close()
        await self.port.stop()


@pytest.fixture
async def cells() -> AsyncIterator[list[FakelessCell]]:
    cells: list[FakelessCell] = []
    yield cells
    for cell in cells:
        await cell.stop()


async def play(port: int, *options: str) -> tuple[int, list[dict[str, object]]]:
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-c", "from fakes.wire.line.plc import app; app()",
        "--port", str(port), *options,
        cwd=ROOT, stdout=asyncio.subprocess.PIPE,
    )  # fmt: skip
    async with asyncio.timeout(30):
        output, _ = await process.communicate()
    assert process.returncode is not None
    return process.returncode, [json.loads(line) for line in output.splitlines()]


async def nothing() -> None:
    pass


async def test_a_good_part_from_aborted_to_completed(cells: list[FakelessCell]) -> None:
    cell = FakelessCell(nothing, Result.GOOD)
    cells.append(cell)
    await cell.start()
    code, lines = await play(cell.port.port, "--serial", "SAT-0042")
    assert code == 0
    assert lines[-1]["event"] == "result"
    assert lines[-1]["result"] == "good"
    assert lines[-1]["run"] == 7
    assert lines[-1]["error_mm"] == [0.01, -0.02, 0.03]
    assert lines[-1]["error_deg"] == [0.001, -0.002, 0.003]
    assert [command.cntrl_cmd for command in cell.commands] == [9, 1, 2]
    assert cell.commands[-1].serial == "SAT-0042"
    assert cell.commands[-1].unit_mode == 1
    reports = [line for line in lines if line["event"] == "report"]
    # The number alone: what it is called is a matter of the cell's process, of which no PLC knows.
    assert all(line["step_number"] == 40 for line in reports[1:])
    assert "correct pose" not in str(reports)


async def test_a_bad_part_and_a_procedure(cells: list[FakelessCell]) -> None:
    cell = FakelessCell(nothing, Result.BAD, State.STOPPED)
    cells.append(cell)
    await cell.start()
    code, lines = await play(cell.port.port, "--mode", "maintenance", "--recipe", "103")
    assert (code, lines[-1]["result"]) == (2, "bad")
    assert (cell.commands[-1].unit_mode, cell.commands[-1].recipe_id) == (2, 103)


async def test_a_part_that_is_held_by_a_fault_is_stopped(cells: list[FakelessCell]) -> None:
    async def execute() -> None:
        raise HoldError("measured nothing")

    cell = FakelessCell(execute, Result.GOOD, State.STOPPED)
    cells.append(cell)
    await cell.start()
    code, lines = await play(cell.port.port)
    assert code == 4
    assert [line["alarms"] for line in lines if line["event"] == "held"] == [[499]]
    assert cell.machine.state is State.STOPPED


async def test_a_job_that_does_not_end_is_stopped_at_its_time_out(
    cells: list[FakelessCell],
) -> None:
    cell = FakelessCell(asyncio.Event().wait, Result.GOOD, State.STOPPED)  # type: ignore[arg-type]
    cells.append(cell)
    await cell.start()
    code, lines = await play(cell.port.port, "--timeout", "0.5")
    assert (code, lines[-1]["result"]) == (5, "timeout")
    await cell.machine.wait_for(State.STOPPED, timeout_s=2)


class Forgetful:
    """Answers come in the moment of a cancellation, which is forgotten (Python before 3.12)."""

    def __init__(self, client: Any) -> None:
        self._client = client
        self.asked = asyncio.Event()

    def __getattr__(self, name: str) -> Any:
        async def ask(*arguments: Any, **named: Any) -> Any:
            answer = asyncio.ensure_future(getattr(self._client, name)(*arguments, **named))
            self.asked.set()
            try:
                return await asyncio.shield(answer)
            except asyncio.CancelledError:
                return await answer

        return ask


async def test_a_forgotten_cancellation_does_not_keep_the_line(cells: list[FakelessCell]) -> None:
    cell = FakelessCell(nothing, Result.GOOD)
    cells.append(cell)
    await cell.start()
    link = await CellLink.open("127.0.0.1", cell.port.port, lambda _report: None, 5.0)
    client, forgetful = link.client, Forgetful(link.client)
    link.client = forgetful  # type: ignore[assignment]
    running = asyncio.create_task(link.run())
    await forgetful.asked.wait()
    link.end()
    running.cancel()
    async with asyncio.timeout(5):
        await asyncio.gather(running, return_exceptions=True)
    client.close()


async def test_a_cell_whose_heart_stops_is_lost(cells: list[FakelessCell]) -> None:
    started = asyncio.Event()

    async def execute() -> None:
        started.set()
        await asyncio.Event().wait()

    cell = FakelessCell(execute, Result.GOOD, State.STOPPED)
    cells.append(cell)
    await cell.start()
    playing = asyncio.create_task(play(cell.port.port))
    async with asyncio.timeout(10):
        await started.wait()
    assert cell.beat is not None
    cell.beat.cancel()
    code, lines = await playing
    assert (code, lines[-1]["result"]) == (6, "lost")


async def test_no_cell_is_a_clear_end() -> None:
    code, lines = await play(1, "--connect-timeout", "0.1")
    assert code == 6
    assert "no cell" in str(lines[-1]["message"])
