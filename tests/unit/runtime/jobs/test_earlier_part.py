"""A serial number that the store already has a finished part for: an alarm, and the run goes on."""

import pytest

from cellctl.errors.line import SerialMadeBefore
from cellctl.packml.command import Command
from cellctl.packml.result import Result
from cellctl.packml.state import State
from tests.unit.daemon_rig import DaemonRig


async def made(rig: DaemonRig, serial: str = "SAT-7", options: int = 0, mate: str = "") -> int:
    """A run to its end; the number of its command."""
    seq = await rig.started(serial=serial, options=options, mate_serial=mate)
    await rig.to(State.COMPLETED)
    return seq


async def test_the_second_part_of_a_number_is_made_with_an_alarm(rig: DaemonRig) -> None:
    await made(rig)
    assert not rig.shown().alarms
    seq = await made(rig)
    assert rig.port.ended[seq] is Result.GOOD
    assert rig.shown().alarms == (SerialMadeBefore.number,)
    record = await rig.record(2)
    (alarm,) = record.alarms
    assert alarm.number == SerialMadeBefore.number
    assert "SAT-7 in run 1, good, " in alarm.text


@pytest.mark.figures  # three parts
async def test_a_third_one_names_the_newest_and_counts_the_others(rig: DaemonRig) -> None:
    for _ in range(3):
        await made(rig)
    (alarm,) = (await rig.record(3)).alarms
    assert "SAT-7 in run 2 and 1 more, good, " in alarm.text


@pytest.mark.figures  # two more parts
async def test_another_number_and_a_dry_run_are_no_such_part(rig: DaemonRig) -> None:
    await made(rig)
    await made(rig, serial="SAT-8")
    await made(rig, options=1)
    await made(rig, serial="SAT-9", options=1)
    await made(rig, serial="SAT-9")
    assert not rig.shown().alarms


async def test_a_part_whose_run_was_stopped_is_begun_anew_without_an_alarm(rig: DaemonRig) -> None:
    rig.contact.may_end.clear()
    await rig.started(serial="SAT-7")
    await rig.contact.reached.wait()
    await rig.take(Command.STOP)
    await rig.to(State.STOPPED)
    rig.contact.may_end.set()
    await made(rig)
    assert [run.result for run in await rig.runs()] == ["good", "stopped"]
    assert not rig.shown().alarms


async def test_a_frame_that_already_has_a_deck_is_an_alarm(rig: DaemonRig) -> None:
    await made(rig, serial="SAT-6", mate="FRAME-2", options=1)
    await made(rig, serial="SAT-7", mate="FRAME-2")
    await made(rig, serial="SAT-8", mate="FRAME-3")
    await made(rig, serial="SAT-9")
    assert not rig.shown().alarms
    seq = await made(rig, serial="SAT-10", mate="FRAME-2")
    assert rig.port.ended[seq] is Result.GOOD
    (alarm,) = (await rig.record(5)).alarms
    assert alarm.number == SerialMadeBefore.number
    assert "joined to FRAME-2 in run 2, good, " in alarm.text
    assert "SAT-10" not in alarm.text


async def test_a_part_that_is_reworked_is_one_alarm_with_both_numbers(rig: DaemonRig) -> None:
    await made(rig, mate="FRAME-2")
    await made(rig, mate="FRAME-2")
    (alarm,) = (await rig.record(2)).alarms
    assert "SAT-7 in run 1, good, " in alarm.text
    assert "; joined to FRAME-2 in run 1, good, " in alarm.text
