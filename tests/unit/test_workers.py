"""The pool of vision workers outlives the death of one of them, and gives way to the daemon."""

import os
import signal

import pytest

from cellctl.errors.internal import WorkerDied
from cellctl.workers import NICE, VisionWorkers


async def noticed(workers: VisionWorkers) -> None:
    while True:
        await workers.check()


async def test_a_death_is_noticed_and_new_workers_take_over() -> None:
    workers = VisionWorkers(count=1)
    try:
        await workers.check()
        workers.revive()
        pid = await workers.run(os.getpid)
        assert pid == await workers.run(os.getpid), "nobody was dead"
        os.kill(pid, signal.SIGKILL)
        with pytest.raises(WorkerDied):
            await noticed(workers)
        workers.revive()
        await workers.check()
        assert await workers.run(os.getpid) != pid
    finally:
        workers.close()


async def test_workers_give_way_to_the_daemon() -> None:
    workers = VisionWorkers(count=1)
    try:
        niceness = await workers.run(os.getpriority, os.PRIO_PROCESS, 0)
    finally:
        workers.close()
    assert niceness == min(os.getpriority(os.PRIO_PROCESS, 0) + NICE, 19)


def blocked() -> set[int]:
    return {int(number) for number in signal.pthread_sigmask(signal.SIG_BLOCK, ())}


async def test_a_worker_is_deaf_to_the_terminal_before_it_runs() -> None:
    workers = VisionWorkers(1)
    try:
        assert {signal.SIGINT, signal.SIGHUP} <= await workers.run(blocked)
        assert not {signal.SIGINT, signal.SIGHUP} & blocked(), "the daemon itself listens"
    finally:
        workers.close()
