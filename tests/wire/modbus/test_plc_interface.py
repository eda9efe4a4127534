"""The line's interface as an outside Modbus client sees it."""

import asyncio
from collections.abc import AsyncIterator, Callable, Mapping
from functools import partial

import pytest
from pymodbus.client import AsyncModbusTcpClient

from cellctl.api.modbus.heartbeat import LineHeartbeat
from cellctl.api.modbus.interface import PlcInterface
from cellctl.api.modbus.submission import LineSubmission
from cellctl.clock import now_s
from cellctl.command.submission import Submission
from cellctl.command.tracker import CommandTracker
from cellctl.config.cell import Plc
from cellctl.errors.line import LineTaskDied
from cellctl.errors.link import ConnectTimeout
from cellctl.packml import Command, PackMLMachine, RejectCode, State
from cellctl.packml.result import Result
from cellctl.packml.unit_command import UnitCommand
from cellctl.runtime.cell_status import CellStatus
from tests.rigs.waiting import until_answer

ACK, DONE, RESULT, REJECT, HEARTBEAT, STATUS, STATE = 7, 8, 9, 10, 11, 5, 2
LOST = 1 << 5


class Line:
    """The interface with a recording stand-in for the arbiter, and a client."""

    def __init__(self) -> None:
        self.commands: list[LineSubmission] = []
        """Commands in the order in which they were executed."""
        self.noted: list[tuple[int | str, RejectCode]] = []
        """Commands that were given up before they were submitted, with why."""
        self.answer: Callable[[LineSubmission], RejectCode] = lambda _submission: RejectCode.NONE
        self.disk = asyncio.Event()
        self.disk.set()
        self.lost = asyncio.Event()
        self.ports: list[PlcInterface] = []
        self.clients: list[AsyncModbusTcpClient] = []
        self.beat = 0
        self.waited_s = 0.0
        """For how long what is read may have been in its socket."""

    async def submit(self, submission: Submission) -> RejectCode:
        """Submit as the arbiter does: Stop and Abort are not validated."""
        assert isinstance(submission, LineSubmission)
        if not submission.command.ends_motion:
            code = await submission.unless_overtaken(self.validate(submission))
            if code is not RejectCode.NONE:
                return code
        return await self.execute(submission)

    async def validate(self, submission: LineSubmission) -> RejectCode:
        code = submission.link_fault()
        if code is RejectCode.NONE:
            await self.disk.wait()
        return code

    async def execute(self, submission: LineSubmission) -> RejectCode:
        self.commands.append(submission)
        code = self.answer(submission)
        if code is RejectCode.NONE:
            submission.taken()
        return code

    async def remember(self, seq: int) -> None:
        """The number is on the disk."""

    def interface(self, config: Plc, previous_seq: int | None = None) -> PlcInterface:
        heartbeat = LineHeartbeat(config.heartbeat_timeout_s, self.lost.set)
        return PlcInterface(
            config,
            self.submit,
            heartbeat,
            self.remember,
            note_refusal=self.note_refusal,
            previous_seq=previous_seq,
            given_s=lambda: now_s() - self.waited_s,
        )

    def note_refusal(
        self, _command: UnitCommand, code: RejectCode, details: Mapping[str, int | str]
    ) -> None:
        self.noted.append((details["seq"], code))

    async def open(
        self, *, previous_seq: int | None = None, timeout_s: float = 5.0
    ) -> tuple[PlcInterface, AsyncModbusTcpClient]:
        config = Plc(port=0, heartbeat_timeout_s=timeout_s)
        port = self.interface(config, previous_seq)
        await port.start()
        self.ports.append(port)
        return port, await self.connect(port)

    async def connect(self, port: PlcInterface, address: str = "127.0.0.1") -> AsyncModbusTcpClient:
        """``address`` is the client's own; every one in 127.0.0.0/8 is this machine."""
        client = AsyncModbusTcpClient(
            "127.0.0.1", port=port.port, timeout=2, retries=0, source_address=(address, 0)
        )
        assert await client.connect()
        self.clients.append(client)
        return client

    async def heartbeat(self, client: AsyncModbusTcpClient) -> None:
        self.beat += 1
        assert not (await client.write_register(40, self.beat)).isError()

    async def command(
        self, client: AsyncModbusTcpClient, seq: int, cmd: int, *, mode: int = 1, serial: str = ""
    ) -> None:
        text = client.convert_to_registers(serial, client.DATATYPE.STRING) if serial else []
        block = [mode, cmd, 1, 0, 0, 0, *(list(text) + [0] * 12)[:12], *[0] * 8, 0, seq]
        await self.heartbeat(client)
        assert not (await client.write_registers(0, block)).isError()


async def inputs(client: AsyncModbusTcpClient) -> list[int]:
    answer = await client.read_input_registers(0, count=125)
    assert not answer.isError()
    assert answer.registers[0] == answer.registers[124]
    return list(answer.registers)


@pytest.fixture
async def line() -> AsyncIterator[Line]:
    line = Line()
    yield line
    for client in line.clients:
        client.close()
    for port in line.ports:
        await port.stop()


async def test_a_command_is_acknowledged_and_later_done(line: Line) -> None:
    port, client = await line.open()
    await line.command(client, 1, Command.START, serial="SAT-0042")
    block = await until_answer(partial(inputs, client), lambda b: b[ACK] == 1)
    assert (block[DONE], block[RESULT], block[REJECT]) == (0, 0, 0)
    assert block[STATUS] & 0b10
    assert line.commands[0].command.serial == "SAT-0042"
    assert line.commands[0].command.who == "line:127.0.0.1"
    port.finish(1, Result.GOOD)
    block = await inputs(client)
    assert (block[DONE], block[RESULT]) == (1, Result.GOOD)
    assert block[STATUS] & 0b110 == 0b100


async def test_a_command_counts_from_before_a_stand_still_and_a_stop_from_now_on(
    line: Line,
) -> None:
    line.waited_s = 60.0
    _, client = await line.open()
    await line.command(client, 1, Command.RESET)
    await until_answer(partial(inputs, client), lambda b: b[ACK] == 1)
    await line.command(client, 2, Command.STOP)
    await until_answer(partial(inputs, client), lambda b: b[ACK] == 2)
    ages_s = [now_s() - one.command.arrived_s for one in line.commands]
    assert ages_s[0] >= 60.0
    assert ages_s[1] < 60.0


async def test_a_refusal_is_a_number_not_a_modbus_exception(line: Line) -> None:
    line.answer = lambda _command: RejectCode.CALIBRATION_INVALID
    _, client = await line.open()
    await line.command(client, 1, Command.START, serial="SAT-1")
    block = await until_answer(partial(inputs, client), lambda b: b[ACK] == 1)
    assert (block[DONE], block[RESULT]) == (1, Result.REJECTED)
    assert block[REJECT] == RejectCode.CALIBRATION_INVALID


async def test_a_fault_while_deciding_refuses_and_the_next_command_is_heard(line: Line) -> None:
    def answer(submission: LineSubmission) -> RejectCode:
        if submission.seq == 1:
            raise ConnectTimeout("main robot")
        return RejectCode.NONE

    line.answer = answer
    _, client = await line.open()
    await line.command(client, 1, Command.RESET)
    block = await until_answer(partial(inputs, client), lambda b: b[ACK] == 1)
    assert block[REJECT] == RejectCode.DEVICE_NOT_READY
    await line.command(client, 2, Command.RESET)
    assert (await until_answer(partial(inputs, client), lambda b: b[ACK] == 2))[REJECT] == 0


async def test_nothing_old_is_executed_after_a_restart(line: Line) -> None:
    _, client = await line.open(previous_seq=7)
    await line.command(client, 7, Command.START, serial="SAT-1")
    block = await until_answer(partial(inputs, client), lambda b: b[ACK] == 7)
    assert (block[RESULT], block[REJECT]) == (
        Result.IGNORED,
        RejectCode.IGNORED_AFTER_RESTART,
    )
    await line.command(client, 8, Command.RESET)
    await until_answer(partial(inputs, client), lambda b: b[ACK] == 8)
    assert [submission.seq for submission in line.commands] == [8]


async def test_the_first_stop_after_a_restart_is_obeyed_whatever_its_number(line: Line) -> None:
    _, client = await line.open(previous_seq=24)
    await client.write_registers(0, [0, Command.ABORT, *[0] * 25, 25])
    block = await until_answer(partial(inputs, client), lambda b: b[ACK] == 25)
    assert block[REJECT] == RejectCode.NONE
    assert [one.command.cntrl_cmd for one in line.commands] == [Command.ABORT]


async def test_without_heartbeat_only_stop_and_abort_are_taken(line: Line) -> None:
    _, client = await line.open()
    for seq, command in enumerate((Command.RESET, Command.STOP, Command.ABORT), start=1):
        await client.write_registers(0, [1, command, *[0] * 25, seq])
        await until_answer(partial(inputs, client), lambda b, seq=seq: b[ACK] == seq)  # type: ignore[misc]
        if seq == 1:
            assert (await inputs(client))[REJECT] == RejectCode.LINE_HEARTBEAT_MISSING
    assert [one.command.cntrl_cmd for one in line.commands] == [Command.STOP, Command.ABORT]


async def test_a_heartbeat_that_stands_still_is_lost_and_comes_back(line: Line) -> None:
    _, client = await line.open(timeout_s=0.5)
    await line.heartbeat(client)
    async with asyncio.timeout(3):
        while not line.lost.is_set():
            await client.write_register(40, line.beat)  # written, but the same value
    assert (await inputs(client))[STATUS] & LOST
    await line.heartbeat(client)
    assert not (await inputs(client))[STATUS] & LOST


async def test_another_client_does_not_keep_the_line_alive(line: Line) -> None:
    port, plc = await line.open(timeout_s=0.5)
    page = await line.connect(port, "127.0.0.2")
    await line.heartbeat(page)  # the first one to beat, as long as nobody commands
    await line.command(plc, 1, Command.RESET)
    await until_answer(partial(inputs, plc), lambda b: b[ACK] == 1)
    async with asyncio.timeout(3):
        while not line.lost.is_set():
            await line.heartbeat(page)
            await asyncio.sleep(0.05)
    await line.heartbeat(page)
    assert (await inputs(page))[STATUS] & LOST
    await line.heartbeat(plc)
    assert not (await inputs(plc))[STATUS] & LOST


async def test_who_gives_a_command_needs_a_heartbeat_of_its_own(line: Line) -> None:
    port, plc = await line.open()
    standby = await line.connect(port, "127.0.0.2")
    await line.command(plc, 1, Command.RESET)
    await until_answer(partial(inputs, plc), lambda b: b[ACK] == 1)
    await standby.write_registers(0, [1, Command.RESET, *[0] * 25, 2])
    block = await until_answer(partial(inputs, standby), lambda b: b[ACK] == 2)
    assert block[REJECT] == RejectCode.LINE_HEARTBEAT_MISSING
    await line.command(standby, 3, Command.RESET)
    block = await until_answer(partial(inputs, standby), lambda b: b[ACK] == 3)
    assert block[REJECT] == RejectCode.NONE


async def test_a_stop_of_another_client_does_not_take_over(line: Line) -> None:
    port, plc = await line.open(timeout_s=0.5)
    page = await line.connect(port, "127.0.0.2")
    await line.command(plc, 1, Command.RESET)
    await until_answer(partial(inputs, plc), lambda b: b[ACK] == 1)
    await line.command(page, 2, Command.STOP)
    await until_answer(partial(inputs, page), lambda b: b[ACK] == 2)
    async with asyncio.timeout(3):
        while not line.lost.is_set():
            await line.heartbeat(page)
            await asyncio.sleep(0.05)


async def test_a_command_has_no_words_of_another_client(line: Line) -> None:
    """The PLC writes its whole image again between a Stop and the number that follows it."""
    port, plc = await line.open()
    page = await line.connect(port, "127.0.0.2")
    await line.command(plc, 1, Command.START, serial="SAT-1")
    await until_answer(partial(inputs, plc), lambda b: b[ACK] == 1)
    await line.heartbeat(page)
    await page.write_registers(0, [0, Command.STOP])
    await line.command(plc, 1, Command.START, serial="SAT-1")
    await page.write_registers(26, [0, 2])
    await until_answer(partial(inputs, page), lambda b: b[ACK] == 2)
    given = [(one.command.cntrl_cmd, one.command.serial) for one in line.commands]
    assert given == [(Command.START, "SAT-1"), (Command.STOP, "")]


async def test_a_refused_command_does_not_take_over(line: Line) -> None:
    port, plc = await line.open(timeout_s=0.5)
    page = await line.connect(port, "127.0.0.2")
    await line.command(plc, 1, Command.RESET)
    await until_answer(partial(inputs, plc), lambda b: b[ACK] == 1)
    line.answer = lambda _submission: RejectCode.DEVICE_NOT_READY
    await line.command(page, 2, Command.START)
    await until_answer(partial(inputs, page), lambda b: b[ACK] == 2)
    async with asyncio.timeout(3):
        while not line.lost.is_set():
            await line.heartbeat(page)
            await asyncio.sleep(0.05)


async def test_the_cells_heartbeat_counts_and_wraps(line: Line) -> None:
    port, client = await line.open()
    port._beats = 0xFFFE
    seen = []
    for _ in range(3):
        port.beat()
        seen.append((await inputs(client))[HEARTBEAT])
    assert seen == [0xFFFF, 0, 1]


async def test_the_cell_does_not_beat_once_commands_are_no_longer_taken(line: Line) -> None:
    def answer(_submission: LineSubmission) -> RejectCode:
        raise RuntimeError("defect")

    line.answer = answer
    port, client = await line.open()
    await line.command(client, 1, Command.RESET)
    with pytest.raises(LineTaskDied, match="defect"):
        async with asyncio.timeout(2):
            await port.failed()
    before = (await inputs(client))[HEARTBEAT]
    port.beat()
    assert (await inputs(client))[HEARTBEAT] == before


async def test_blocks_are_never_torn(line: Line) -> None:
    port, client = await line.open()
    stop = asyncio.Event()

    async def publish() -> None:
        number = 0
        while not stop.is_set():
            number += 1
            port.publish(CellStatus(run_number=number, cycle_counter=number))
            await asyncio.sleep(0)

    publishing = asyncio.create_task(publish())
    for _ in range(200):
        block = await inputs(client)
        assert block[23:25] == block[25:27]
    stop.set()
    await publishing


async def test_commands_come_in_order_though_validation_takes_time(line: Line) -> None:
    _, client = await line.open()
    line.disk.clear()
    for seq in range(1, 6):
        await line.command(client, seq, Command.RESET)
    assert line.commands == []
    line.disk.set()
    await until_answer(partial(inputs, client), lambda b: b[ACK] == 5)
    assert [submission.seq for submission in line.commands] == [1, 2, 3, 4, 5]


@pytest.mark.parametrize("end", [Command.STOP, Command.ABORT])
async def test_stop_and_abort_wait_for_no_command_and_nothing_older_follows(
    line: Line, end: Command
) -> None:
    port, client = await line.open()
    answers = answered(port)
    line.disk.clear()
    await line.command(client, 1, Command.RESET)
    await line.command(client, 2, Command.UNHOLD)
    await line.command(client, 3, end)
    block = await until_answer(partial(inputs, client), lambda b: b[ACK] == 3)
    assert block[REJECT] == 0
    superseded = RejectCode.SUPERSEDED
    assert answers == [(1, superseded), (2, superseded), (3, RejectCode.NONE)]
    line.disk.set()
    await line.command(client, 4, Command.HOLD)
    await until_answer(partial(inputs, client), lambda b: b[ACK] == 4)
    assert [submission.seq for submission in line.commands] == [3, 4]


async def test_a_flood_of_commands_drops_the_oldest_with_an_answer_but_no_abort(
    line: Line,
) -> None:
    port, client = await line.open()
    answers = answered(port)
    line.disk.clear()
    for seq in range(1, 21):
        await line.command(client, seq, Command.HOLD)
    assert answers == [(seq, RejectCode.SUPERSEDED) for seq in (2, 3, 4)]
    assert line.noted == answers, "the audit log is told of what no arbiter has seen"
    await line.command(client, 21, Command.ABORT)
    for seq in range(22, 42):
        await line.command(client, seq, Command.HOLD)
    line.disk.set()
    await until_answer(partial(inputs, client), lambda b: b[ACK] == 41)
    assert sorted({seq for seq, _ in answers}) == list(range(1, 42))
    assert line.commands[0].command.cntrl_cmd == Command.ABORT


def answered(port: PlcInterface) -> list[tuple[int, RejectCode]]:
    """Every number with its answer, in order, however short it stands in the registers."""
    answers: list[tuple[int, RejectCode]] = []
    latch = port._latch
    accept, reject, supersede = latch.accept, latch.reject, latch.supersede

    def accepted(seq: int) -> None:
        answers.append((seq, RejectCode.NONE))
        accept(seq)

    def rejected(seq: int, code: RejectCode) -> None:
        answers.append((seq, code))
        reject(seq, code)

    def superseded(seq: int) -> None:
        answers.append((seq, RejectCode.SUPERSEDED))
        supersede(seq)

    latch.accept, latch.reject, latch.supersede = accepted, rejected, superseded  # type: ignore[method-assign]
    return answers


async def test_a_cycle_of_the_unit_over_the_wire(line: Line) -> None:
    machine = PackMLMachine({}, initial=State.ABORTED)
    port = line.interface(Plc(port=0))
    line.execute = CommandTracker(machine, lambda: Result.GOOD).execute  # type: ignore[method-assign]
    machine.on_change.append(
        lambda _before, after: port.publish(
            CellStatus(state=after, state_requested=machine.state_requested, mode=machine.mode)
        )
    )
    await port.start()
    line.ports.append(port)
    client = await line.connect(port)
    expected = [
        (Command.CLEAR, State.STOPPED),
        (Command.RESET, State.IDLE),
        (Command.START, State.COMPLETED),
        (Command.RESET, State.IDLE),
        (Command.ABORT, State.ABORTED),
    ]
    for seq, (command, state) in enumerate(expected, start=1):
        await line.command(client, seq, command, serial="SAT-0042")
        block = await until_answer(partial(inputs, client), lambda b, seq=seq: b[DONE] == seq)  # type: ignore[misc]
        assert (block[STATE], block[RESULT]) == (state, Result.GOOD)
    await line.command(client, 6, Command.START, serial="SAT-0042")
    block = await until_answer(partial(inputs, client), lambda b: b[DONE] == 6)
    assert block[REJECT] == RejectCode.COMMAND_NOT_ALLOWED
    await line.command(client, 7, Command.UNDEFINED, mode=2)
    block = await until_answer(partial(inputs, client), lambda b: b[DONE] == 7)
    assert (block[3], block[RESULT]) == (2, Result.GOOD)
    await line.command(client, 8, Command.UNDEFINED, mode=2)
    assert (await until_answer(partial(inputs, client), lambda b: b[DONE] == 8))[
        RESULT
    ] == Result.GOOD
    await machine.close()


async def test_people_are_shown_what_a_plc_reads_and_has_written(line: Line) -> None:
    port, client = await line.open()
    await line.command(client, 7, Command.START, serial="SAT-0042")
    block = await until_answer(partial(inputs, client), lambda registers: registers[ACK] == 7)
    shown = {entry["name"]: entry for entry in port.shown()}
    for name, address in (("ack_seq", ACK), ("state", STATE), ("reject_code", REJECT)):
        assert (shown[name]["address"], shown[name]["value"]) == (address, block[address])
    assert (shown["cmd_seq"]["writer"], shown["cmd_seq"]["value"]) == ("line", "7")
    assert shown["test_text"]["value"] == "ABCDEF"


async def test_a_run_keeps_registers_of_both_sides_without_their_counters(line: Line) -> None:
    port, client = await line.open()
    await line.command(client, 1, Command.RESET, serial="SAT-0042")
    await until_answer(partial(inputs, client), lambda registers: registers[ACK] == 1)
    port.publish(CellStatus(state=State.IDLE, serial="SAT-0042"))
    recorded = port.recorded()
    to_line, from_line = recorded["/registers/input"], recorded["/registers/holding"]
    assert (to_line["state"], to_line["ack_seq"], to_line["serial_echo"]) == (4, 1, "SAT-0042")
    assert (from_line["cmd_seq"], from_line["serial"]) == (1, "SAT-0042")
    # Plain numbers: an enumeration would be another JSON.
    assert {type(value) for value in to_line.values()} <= {int, float, str}
    # The cell's own and the line's heartbeat alone make no further message.
    port.beat()
    await line.heartbeat(client)
    assert port.recorded() == recorded


async def test_a_value_that_there_is_not_is_shown_as_none(line: Line) -> None:
    """On the wire it has a number of its own, which nobody at a page knows."""
    port, _client = await line.open()
    shown = {one["name"]: one["value"] for one in port.shown()}
    assert shown["force_z"] is None
    assert isinstance(shown["state"], int)
