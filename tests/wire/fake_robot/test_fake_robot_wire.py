"""The fake controller on sockets: channels, reconnects, violations, faults of a bad line."""

import asyncio
import time
from types import CoroutineType

import pytest

from fakes.wire.sjl.records import encode
from tests.wire.fake_robot.fake_robot_pc import Line, Pc, controller

WORK = (0, -85, 95, 0, 85, 90)


async def test_hello_names_everything_that_must_agree() -> None:
    pc = Pc()
    async with controller(pc, "CMD", "STA", "GRD"):
        for channel in ("CMD", "STA", "GRD"):
            line = await pc.accepted(channel)
            assert line.hello == [
                "HELLO", "SJL", "1", channel, "SR500A", "1.0", "EUL=ZYX", "UNIT=MMDEG",
                "STEPMAX=0.5000", "DEADMAN=300",
            ]  # fmt: skip


async def test_joint_motion_from_command_to_done_with_state_on_the_way() -> None:
    pc = Pc()
    async with controller(pc, "CMD", "STA"):
        cmd, sta = await pc.accepted("CMD"), await pc.accepted("STA")
        cmd.send("MOVJ", cmd.session, 1, *WORK, 100)
        assert await cmd.next("ACK", "REJ") == ["ACK", "1"]
        moving = {(await sta.next("STAT"))[6] for _ in range(10)}
        assert "1" in moving
        done = await cmd.next("DONE", "ABRT")
        assert done[:2] == ["DONE", "1"]
        while (state := await sta.next("STAT"))[6] == "1":
            pass
        assert state[10:16] == done[2:]
        assert [float(angle) for angle in state[16:]] == pytest.approx(WORK, abs=1e-4)


async def test_state_comes_at_50_hz_and_counts_up() -> None:
    pc = Pc()
    async with controller(pc, "STA"):
        sta = await pc.accepted("STA")
        await sta.next("STAT")
        began_s = time.monotonic()
        numbers = [int((await sta.next("STAT"))[1]) for _ in range(25)]
        assert time.monotonic() - began_s == pytest.approx(0.5, abs=0.2)
        assert numbers == list(range(numbers[0], numbers[0] + 25))


async def test_refused_hello_is_tried_again() -> None:
    pc = Pc()
    pc.answer = lambda session: ["NO", "HELLO", "VERSION"]
    async with controller(pc, "CMD") as device:
        first = await pc.accepted("CMD")
        await asyncio.wait_for(first.ended.wait(), 2)
        assert device.open_channels == []
        pc.answer = lambda session: ["OK", "HELLO", "1", str(session)]
        second = await pc.accepted("CMD")
        second.send("REARM", second.session, 1)
        assert await second.next("REJ", "ACK") == ["ACK", "1"]


async def test_cut_links_stay_away_until_the_fault_is_cleared() -> None:
    pc = Pc()
    async with controller(pc, "CMD", "STA") as device:
        lines = [await pc.accepted("CMD"), await pc.accepted("STA")]
        device.faults.inject("cut")
        for line in lines:
            await asyncio.wait_for(line.ended.wait(), 2)
        for _ in range(200):  # the PC may see the end of a line before the controller does
            if not device.open_channels:
                break
            await asyncio.sleep(0.01)
        assert device.open_channels == []
        assert device.logic.latched
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(pc.accepted("CMD"), 1.0)
        device.faults.clear("cut")
        await asyncio.wait_for(pc.accepted("CMD"), 2)


async def test_lost_channel_comes_back_latched_with_a_new_session() -> None:
    pc = Pc()
    async with controller(pc, "CMD", "STA"):
        cmd, sta = await pc.accepted("CMD"), await pc.accepted("STA")
        sta.writer.close()
        again = await pc.accepted("STA")
        assert again.session != sta.session
        assert (await again.next("STAT"))[7] == "1"
        cmd.send("MOVJ", cmd.session, 1, *WORK, 10)
        assert await cmd.next("ACK", "REJ") == ["REJ", "1", "LATCHED"]
        cmd.send("REARM", cmd.session, 2)
        assert await cmd.next("ACK", "REJ") == ["ACK", "2"]


@pytest.mark.parametrize(
    "record",
    [b"MOVJ,1,1*00\n", b"nonsense\n", encode(["JUMP", "1", "1"]), b"x" * 400, b"\xff\xfe\n"],
)
async def test_protocol_violation_drops_all_channels_and_latches(record: bytes) -> None:
    pc = Pc()
    async with controller(pc, "CMD", "STA") as device:
        cmd, sta = await pc.accepted("CMD"), await pc.accepted("STA")
        cmd.writer.write(record)
        await asyncio.wait_for(cmd.ended.wait(), 2)
        await asyncio.wait_for(sta.ended.wait(), 2)
        await pc.accepted("CMD")
        await pc.accepted("STA")
        assert device.logic.latched


async def test_silence_of_the_pc_stops_a_motion() -> None:
    pc = Pc()
    async with controller(pc, "CMD", "STA"):
        cmd, _ = await pc.accepted("CMD"), await pc.accepted("STA")
        cmd.send("MOVJ", cmd.session, 1, *WORK, 5)
        await cmd.next("ACK")
        pc.beating = False
        assert (await cmd.next("DONE", "ABRT"))[:3] == ["ABRT", "1", "DEADMAN"]


@pytest.mark.parametrize("fault", ["split", "merged", "dribbled"])
async def test_records_survive_an_odd_stream(fault: str) -> None:
    pc = Pc()
    async with controller(pc, "CMD", "STA") as device:
        cmd, sta = await pc.accepted("CMD"), await pc.accepted("STA")
        device.faults.inject(fault, records=2)
        states = [await sta.next("STAT") for _ in range(4)]
        assert all(len(state) == 22 for state in states)
        cmd.send("REARM", cmd.session, 1)
        assert await cmd.next("ACK") == ["ACK", "1"]


async def test_corrupt_record_keeps_its_old_sum() -> None:
    pc = Pc()
    async with controller(pc, "CMD", "STA") as device:
        cmd, sta = await pc.accepted("CMD"), await pc.accepted("STA")
        device.faults.inject("corrupt", count=1)
        assert cmd.hello
        with pytest.raises(ValueError, match="wrong sum"):
            await asyncio.wait_for(_spoiled(sta), 2)


async def _spoiled(line: Line) -> None:
    """Raises what the collector of the line met."""
    await next(task for task in asyncio.all_tasks() if _collects(task, line))


def _collects(task: asyncio.Task[None], line: Line) -> bool:
    coroutine = task.get_coro()
    if not isinstance(coroutine, CoroutineType) or coroutine.__qualname__ != "Line.collect":
        return False
    frame = coroutine.cr_frame
    return frame is not None and frame.f_locals["self"] is line


@pytest.mark.parametrize("fault", ["silent", "half_open"])
async def test_silent_line_stays_open(fault: str) -> None:
    pc = Pc()
    async with controller(pc, "STA") as device:
        sta = await pc.accepted("STA")
        await sta.next("STAT")
        device.faults.inject(fault)
        await asyncio.sleep(0.1)
        while not sta.records.empty():
            sta.records.get_nowait()
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(sta.records.get(), 0.2)
        assert not sta.ended.is_set()


async def test_frozen_state_repeats_its_last_record() -> None:
    pc = Pc()
    async with controller(pc, "STA") as device:
        sta = await pc.accepted("STA")
        await sta.next("STAT")
        device.faults.inject("frozen_stat")
        records = [await sta.next("STAT") for _ in range(8)]
        assert records[-1] == records[-2] == records[-3]


@pytest.mark.parametrize(
    ("fault", "index", "text"),
    [
        ("wrong_version", 2, "9"),
        ("wrong_euler", 6, "EUL=ZYZ"),
        ("other_euler", 6, "EUL=XYZ"),
        ("wrong_unit", 7, "UNIT=MRAD"),
        ("wrong_name", 4, "NOBODY"),
    ],
)
async def test_wrong_hello(fault: str, index: int, text: str) -> None:
    pc = Pc()
    async with controller(pc, "CMD") as device:
        line = await pc.accepted("CMD")
        device.faults.inject(fault)
        line.writer.close()
        assert (await pc.accepted("CMD")).hello[index] == text


async def test_reboot_brings_new_sessions_and_no_latch() -> None:
    pc = Pc()
    async with controller(pc, "CMD", "STA") as device:
        cmd, sta = await pc.accepted("CMD"), await pc.accepted("STA")
        sta.send("ABORT", sta.session, 1)
        await sta.next("STOPD")
        await device.reboot()
        await asyncio.wait_for(cmd.ended.wait(), 2)
        await pc.accepted("CMD")
        assert (await (await pc.accepted("STA")).next("STAT"))[7] == "0"
