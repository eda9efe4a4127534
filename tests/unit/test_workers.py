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
