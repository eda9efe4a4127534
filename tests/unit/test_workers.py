"""The pool of vision workers outlives the death of one of them, and gives way to the daemon."""

import asyncio
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from cellctl.errors.internal import WorkerDied, WorkerSilent
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


async def test_a_worker_that_hangs_is_noticed_ended_and_replaced() -> None:
    workers = VisionWorkers(count=1)
    try:
        pid = await workers.run(os.getpid)
        os.kill(pid, signal.SIGSTOP)
        with pytest.raises(WorkerSilent, match="getpid"):
            async with asyncio.timeout(10):
                await workers.run_within(0.2, os.getpid)
        with pytest.raises(WorkerDied):
            await workers.run_within(0.2, os.getpid)
        workers.revive()
        assert await workers.run(os.getpid) != pid
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)
    finally:
        workers.close()


async def test_an_ending_daemon_does_not_wait_for_a_worker_that_hangs() -> None:
    workers = VisionWorkers(count=1, close_s=0.2)
    pid = await workers.run(os.getpid)
    os.kill(pid, signal.SIGSTOP)
    await asyncio.wait_for(asyncio.to_thread(workers.close), 10)
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


KILLED_DAEMON = """
import asyncio, os, signal, time
from cellctl.workers import VisionWorkers

async def main():
    workers = VisionWorkers(count=1)
    print(await workers.run(os.getpid), flush=True)
    asyncio.create_task(workers.run(time.sleep, 60.0))
    await asyncio.sleep(0.1)
    os.kill(os.getpid(), signal.SIGKILL)

if __name__ == "__main__":
    asyncio.run(main())
"""


def test_a_worker_that_is_at_work_ends_with_its_daemon(tmp_path: Path) -> None:
    program = tmp_path / "daemon.py"
    program.write_text(KILLED_DAEMON)
    daemon = subprocess.run([sys.executable, program], check=False, capture_output=True, text=True)
    assert daemon.returncode == -signal.SIGKILL, daemon.stderr
    deadline_s = time.monotonic() + 5.0
    while Path(f"/proc/{int(daemon.stdout)}").exists():
        assert time.monotonic() < deadline_s, "still at work"
        time.sleep(0.02)


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


async def test_who_learns_late_of_an_earlier_death_does_no_harm_to_the_new_workers() -> None:
    workers = VisionWorkers(count=1)
    try:
        pid = await workers.run(os.getpid)
        os.kill(pid, signal.SIGSTOP)
        late = asyncio.create_task(workers.run_within(60.0, os.getpid))
        await asyncio.sleep(0)
        with pytest.raises(WorkerSilent):
            await workers.run_within(0.2, os.getpid)
        workers.revive()
        new = await workers.run(os.getpid)
        with pytest.raises(WorkerDied):
            await late
        assert await workers.run(os.getpid) == new
    finally:
        workers.close()


@pytest.mark.parametrize("count", [1, 2])
async def test_a_worker_that_cannot_be_started_is_a_numbered_fault(count: int) -> None:
    """With ``count`` of 2, after one that runs."""
    workers = VisionWorkers(count=count)
    limits = resource.getrlimit(resource.RLIMIT_NOFILE)
    try:
        busy = [asyncio.create_task(workers.run(time.sleep, 30.0)) for _ in range(count - 1)]
        await asyncio.sleep(0)
        # The descriptors that are open stay, and no further one can be had.
        resource.setrlimit(resource.RLIMIT_NOFILE, (_lowest_free_descriptor(), limits[1]))
        try:
            with pytest.raises(WorkerDied, match=r"cannot be started: .*Too many open files"):
                await workers.run(os.getpid)
        finally:
            resource.setrlimit(resource.RLIMIT_NOFILE, limits)
        with pytest.raises(WorkerDied, match="not yet replaced"):
            await workers.run(os.getpid)
        workers.revive()
        assert await workers.run(os.getpid)
        for task in busy:
            with pytest.raises(WorkerDied):
                await task
    finally:
        workers.close()


def _lowest_free_descriptor() -> int:
    descriptor = os.dup(0)
    os.close(descriptor)
    return descriptor
