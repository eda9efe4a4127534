"""When registers are a command, and the numbers of the handshake."""

import pytest

from cellctl.api.modbus.encoding import encode
from cellctl.api.modbus.latch import CommandLatch
from cellctl.api.modbus.register_map import HOLDING_SIZE, item
from cellctl.packml import Command, RejectCode
from cellctl.packml.result import Result
from cellctl.packml.unit_command import Source, UnitCommand

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
        holding(1, unit_mode=1, cntrl_cmd=2, recipe_id=1, serial="SAT-0001", mate_serial="FRAME-3")
    )
    assert command == (1, START)


def test_a_number_counts_once() -> None:
    latch = CommandLatch(None, "big")
    assert latch.commit(holding(1, cntrl_cmd=1)) is not None
    assert latch.commit(holding(1, cntrl_cmd=8)) is None
    assert latch.commit(holding(2, cntrl_cmd=8)) is not None


@pytest.mark.parametrize(("previous", "first"), [(None, 7), (7, 7), (7, 8), (1, 1)])
def test_what_stood_in_the_registers_at_the_start_is_ignored(
    previous: int | None, first: int
) -> None:
    latch = CommandLatch(previous, "big")
    assert latch.commit(holding(first, cntrl_cmd=2)) is None
    assert (latch.ack_seq, latch.done_seq) == (first, first)
    assert latch.result is Result.IGNORED
    assert latch.reject_code is RejectCode.IGNORED_AFTER_RESTART
    assert latch.commit(holding(first + 1, cntrl_cmd=2)) is not None


@pytest.mark.parametrize("command", [Command.STOP, Command.ABORT, Command.HOLD, Command.SUSPEND])
@pytest.mark.parametrize(("previous", "first"), [(None, 25), (25, 25), (24, 25), (1, 1)])
def test_what_halts_the_unit_is_obeyed_from_the_first_number_on(
    command: Command, previous: int | None, first: int
) -> None:
    latch = CommandLatch(previous, "big")
    assert latch.commit(holding(first, cntrl_cmd=command)) == (
        first,
        UnitCommand(Source.LINE, cntrl_cmd=command),
    )
    # The number was seen: the PLC counts on from it, and what comes next is no leftover.
    assert latch.commit(holding(first + 1, cntrl_cmd=Command.RESET)) is not None


def test_a_line_that_begins_anew_with_1_is_heard() -> None:
    assert CommandLatch(41, "big").commit(holding(1, cntrl_cmd=1)) is not None


def test_zero_is_no_command_and_takes_nothing_back_from_the_restart_rule() -> None:
    latch = CommandLatch(7, "big")
    assert latch.commit(holding(0, cntrl_cmd=2)) is None
    assert latch.commit(holding(7, cntrl_cmd=2)) is None
    assert latch.result is Result.IGNORED


def test_acknowledged_then_done() -> None:
    latch = CommandLatch(None, "big")
    latch.commit(holding(1, cntrl_cmd=1))
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
