"""A short soak of every way to an arm, and what it must be able to notice."""

import asyncio
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest

from benchmarks.robot.quick_time import QuickTime
from benchmarks.robot.soak import Count, main, soak, table
from benchmarks.robot.soaked import WAYS, Soaked, sjl

MOVES = 25


@pytest.mark.parametrize("way", sorted(WAYS))
def test_nothing_is_lost_doubled_stale_or_late(way: str) -> None:
    count = QuickTime().run(soak(WAYS[way], MOVES, seed=3))
    assert count.moves == MOVES
    assert count.good, table({way: count})
    assert count.finished > MOVES / 4
    assert count.ended_early > MOVES / 8
    assert len(count.faults) > 5


def test_a_motion_that_is_made_twice_is_noticed() -> None:
    async def twice() -> Count:
        @asynccontextmanager
        async def repeating() -> AsyncIterator[Soaked]:
            async with sjl() as soaked:
                soaked.known = {"again": lambda s, _: again(s)}
                yield soaked

        return await soak(repeating, 2, seed=1)

    def again(soaked: Soaked) -> None:
        """The arm begins once more, of itself, as soon as it stands."""

        async def begin() -> None:
            while soaked.moving() or not soaked.begun_s:  # noqa: ASYNC110  the arm has no event
                await asyncio.sleep(0.01)
            now_s = soaked.arm.standstill_s + 0.01
            soaked.arm.start_linear(now_s, soaked.arm.encoder_pose(now_s), 0.1, 1.0)

        running.append(asyncio.create_task(begin()))

    running: list[asyncio.Task[None]] = []
    count = QuickTime().run(twice())
    assert count.doubled > 0
    assert not count.good


def test_time_jumps_and_does_not_wait() -> None:
    async def hour() -> float:
        began_s = time.monotonic()
        await asyncio.sleep(3600.0)
        return time.monotonic() - began_s

    began_s = time.monotonic()
    assert QuickTime().run(hour()) == pytest.approx(3600.0, abs=0.01)
    assert time.monotonic() - began_s < 10.0


def test_the_same_seed_is_the_same_soak() -> None:
    counts = [QuickTime().run(soak(sjl, 5, seed=7)) for _ in range(2)]
    assert counts[0].faults == counts[1].faults


def test_the_command_prints_the_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--moves", "2", "--way", "sjl"]) == 0
    assert "| sjl | 2 |" in capsys.readouterr().out
