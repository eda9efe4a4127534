"""When registers are a command, and the numbers of the handshake."""

import pytest

from cellctl.api.modbus.encoding import encode
from cellctl.api.modbus.latch import CommandLatch
from cellctl.api.modbus.register_map import HOLDING_SIZE, item
from cellctl.packml import Command, RejectCode
from cellctl.packml.result import Result
from cellctl.packml.unit_command import Source, UnitCommand

PLC, OTHER = "192.168.10.5", "192.168.10.9"

START = UnitCommand(
    Source.LINE, unit_mode=1, cntrl_cmd=2, recipe_id=1, serial="SAT-0001", mate_serial="FRAME-3"
)


def holding(seq: int, **values: int | str) -> list[int]:
    block = [0] * HOLDING_SIZE
    for name, value in {"cmd_seq": seq, **values}.items():
        entry = item(name)
        block[entry.address : entry.address + entry.length] = encode(entry, value, "big")
    return block


def test_the_block_is_latched_as_it_stands() -> None:
    command = CommandLatch(None, "big").commit(
        holding(1, unit_mode=1, cntrl_cmd=2, recipe_id=1, serial="SAT-0001", mate_serial="FRAME-3"),
        PLC,
    )
    assert command == (1, START)


def test_a_number_counts_once() -> None:
    latch = CommandLatch(None, "big")
    assert latch.commit(holding(1, cntrl_cmd=1), PLC) is not None
    assert latch.commit(holding(1, cntrl_cmd=Command.CLEAR), PLC) is None
    assert latch.commit(holding(2, cntrl_cmd=Command.CLEAR), PLC) is not None


@pytest.mark.parametrize(("previous", "first"), [(None, 7), (7, 7), (7, 8), (1, 1)])
def test_what_stood_in_the_registers_at_the_start_is_ignored(
    previous: int | None, first: int
) -> None:
    latch = CommandLatch(previous, "big")
    assert latch.commit(holding(first, cntrl_cmd=2), PLC) is None
    assert (latch.ack_seq, latch.done_seq) == (first, first)
    assert latch.result is Result.IGNORED
    assert latch.reject_code is RejectCode.IGNORED_AFTER_RESTART
    assert latch.commit(holding(first + 1, cntrl_cmd=2), PLC) is not None


@pytest.mark.parametrize("command", [Command.STOP, Command.ABORT, Command.HOLD, Command.SUSPEND])
@pytest.mark.parametrize(("previous", "first"), [(None, 25), (25, 25), (24, 25), (1, 1)])
def test_what_halts_the_unit_is_obeyed_from_the_first_number_on(
    command: Command, previous: int | None, first: int
) -> None:
    latch = CommandLatch(previous, "big")
    assert latch.commit(holding(first, cntrl_cmd=command), PLC) == (
        first,
        UnitCommand(Source.LINE, cntrl_cmd=command),
    )
    # The number was seen: the PLC counts on from it, and what comes next is no leftover.
    assert latch.commit(holding(first + 1, cntrl_cmd=Command.RESET), PLC) is not None


def test_a_line_that_begins_anew_with_1_is_heard() -> None:
    assert CommandLatch(41, "big").commit(holding(1, cntrl_cmd=1), PLC) is not None


def test_zero_is_no_command_and_takes_nothing_back_from_the_restart_rule() -> None:
    latch = CommandLatch(7, "big")
    assert latch.commit(holding(0, cntrl_cmd=2), PLC) is None
    assert latch.commit(holding(7, cntrl_cmd=2), PLC) is None
    assert latch.result is Result.IGNORED


def test_acknowledged_then_done() -> None:
    latch = CommandLatch(None, "big")
    latch.commit(holding(1, cntrl_cmd=1), PLC)
    latch.begin(1)
    latch.accept(1)
    assert (latch.ack_seq, latch.done_seq, latch.result) == (1, 0, Result.NONE)
    assert latch.finish(1, Result.GOOD)
    assert (latch.done_seq, latch.result) == (1, Result.GOOD)
    assert not latch.finish(1, Result.ABORTED)
    assert latch.result is Result.GOOD


def test_a_command_may_end_before_it_is_accepted() -> None:
    latch = CommandLatch(None, "big")
    latch.begin(1)
    assert latch.finish(1, Result.GOOD)
    assert latch.ack_seq == 0
    latch.accept(1)
    assert (latch.ack_seq, latch.done_seq, latch.result) == (1, 1, Result.GOOD)


def test_a_refused_command_is_done_at_once() -> None:
    latch = CommandLatch(None, "big")
    latch.begin(3)
    latch.reject(3, RejectCode.CALIBRATION_INVALID)
    assert (latch.ack_seq, latch.done_seq, latch.result) == (3, 3, Result.REJECTED)
    assert latch.reject_code is RejectCode.CALIBRATION_INVALID


def test_a_later_command_takes_the_place_of_an_earlier_one() -> None:
    latch = CommandLatch(None, "big")
    latch.accept(1)
    latch.accept(2)
    assert not latch.finish(1, Result.GOOD)
    assert latch.finish(2, Result.GOOD)


def test_what_a_plc_repeats_is_no_new_command_after_another_client_has_spoken() -> None:
    latch = CommandLatch(None, "big")
    latch.commit(holding(6, cntrl_cmd=Command.CLEAR), PLC)
    reset = holding(7, cntrl_cmd=Command.RESET)
    assert latch.commit(reset, PLC) is not None
    assert latch.commit(holding(4242, cntrl_cmd=Command.STOP), OTHER) is not None
    assert latch.commit(reset, PLC) is None


def test_the_first_number_of_each_client_is_suspect() -> None:
    latch = CommandLatch(7, "big")
    assert latch.commit(holding(77, cntrl_cmd=Command.STOP), OTHER) is not None
    reset = holding(7, cntrl_cmd=Command.RESET)
    assert latch.commit(reset, PLC) is None
    assert latch.result is Result.IGNORED
    assert latch.commit(holding(78, cntrl_cmd=Command.STOP), OTHER) is not None
    assert latch.commit(reset, PLC) is None


@pytest.mark.parametrize("command", [Command.STOP, Command.ABORT])
def test_what_halts_is_obeyed_with_a_number_that_was_used_already(command: Command) -> None:
    latch = CommandLatch(None, "big")
    assert latch.commit(holding(1, cntrl_cmd=Command.START), PLC) is not None
    halt = holding(1, cntrl_cmd=command)
    assert latch.commit(halt, OTHER) is not None
    assert latch.commit(halt, PLC) is not None
    # An image that is written again and again must not halt the cell again and again.
    assert latch.commit(halt, PLC) is None


def test_a_client_that_clears_its_registers_takes_no_answer_from_another() -> None:
    latch = CommandLatch(None, "big")
    latch.commit(holding(1, cntrl_cmd=Command.START), PLC)
    latch.begin(1)
    latch.accept(1)
    latch.commit(holding(0), OTHER)
    assert latch.ack_seq == 1
    latch.commit(holding(0), PLC)
    assert latch.ack_seq == 0


def test_a_client_that_has_read_the_handshake_is_heard_at_once() -> None:
    latch = CommandLatch(8, "big")
    latch.commit(holding(1, cntrl_cmd=Command.RESET), PLC)
    latch.accept(1)
    assert latch.commit(holding(2, cntrl_cmd=Command.RESET), OTHER) is not None
    # Not so where the number stood in its registers already before the start.
    latch = CommandLatch(8, "big")
    latch.commit(holding(7, cntrl_cmd=Command.STOP), OTHER)
    latch.accept(7)
    assert latch.commit(holding(8, cntrl_cmd=Command.RESET), PLC) is None
