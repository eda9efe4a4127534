"""Many motions, most of them with something that goes wrong: ``make soak-robot``.

    python -m benchmarks.robot.soak --moves 10000 --out build/soak-robot.json

For each way to an arm: motions that the driver reported as done and that were not, motions that
the arm made twice or resumed, motions that began on an old state, and calls that took longer than
their time-outs allow. All four must be zero. Driver and fake controller share one process whose
time does not wait (``quick_time``).
"""

import argparse
import asyncio
import json
import logging
import random
import sys
import time
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform

from benchmarks.robot.quick_time import QuickTime
from benchmarks.robot.soaked import DELAY_S, MOVE_TIMEOUT_S, WAYS, Soaked
from cellctl.errors.base import CellError
from cellctl.errors.link import LinkError
from cellctl.interfaces.robot import RobotState

STALE_S = 0.25
"""Default of both drivers."""
TOLERANCE_M = 1e-4
MOVE_END_S = MOVE_TIMEOUT_S + 3.0 + 1.0
"""The time-outs of a motion, of the stop behind it, and of the answer to a command."""
REARM_S = 30.0
_BEFORE = 0.3
"""Share of the faults that come before the motion, which may then begin on an old state."""
PAUSE_S = 0.05
"""Time between two tries of an operator to acknowledge."""


@dataclass
class Count:
    """What has been seen on one way."""

    moves: int = 0
    finished: int = 0
    ended_early: int = 0
    lost: int = 0
    """Reported as finished, and not at the target or not standing."""
    doubled: int = 0
    """Motions of the arm beyond the one of a call, until the next call."""
    stale: int = 0
    """Motions that began on a state older than allowed."""
    begun_unlinked: int = 0
    """Motions whose command had left before the link was lost; allowed, since they are stopped."""
    beyond_time_outs: int = 0
    not_released: int = 0
    """Faults after which the arm could not be used again."""
    longest_end_s: float = 0.0
    longest_release_s: float = 0.0
    greatest_state_age_s: float = 0.0
    fake_hours: float = 0.0
    faults: dict[str, int] = field(default_factory=dict)
    """How often each was injected."""
    wrong: dict[int, str] = field(default_factory=dict)
    """Motions after which something had happened that must not, and the fault that they had."""

    @property
    def good(self) -> bool:
        """Nothing happened that must not."""
        return not any(
            (self.lost, self.doubled, self.stale, self.beyond_time_outs, self.not_released)
        )


class Soak:
    """Motions of one arm, one after the other."""

    def __init__(self, soaked: Soaked, rng: random.Random, count: Count) -> None:
        self._soaked, self._rng, self._count = soaked, rng, count
        self._home = soaked.robot.state().base_T_flange
        soaked.watch(time.monotonic)

    async def move(self) -> None:
        """A motion, a fault shortly before it or in it, its end, and the release."""
        soaked, rng, count = self._soaked, self._rng, self._count
        name = rng.choice(sorted(soaked.known))
        aged, before = len(soaked.ages_s), len(soaked.begun_s)
        before_it = rng.random() < _BEFORE
        if before_it:
            soaked.known[name](soaked, rng)
            await asyncio.sleep(rng.uniform(0.0, 2 * STALE_S))
        # Nobody has asked for one yet.
        count.doubled += len(soaked.begun_s) - before
        up = RigidTransform.from_translation([0.0, 0.0, rng.uniform(-0.01, 0.01)])
        target, before = up * self._home, len(soaked.begun_s)
        began_s = time.monotonic()
        job = asyncio.create_task(
            soaked.robot.move_linear(target, speed_m_s=0.1, acceleration_m_s2=1.0)
        )
        if not before_it:
            await asyncio.sleep(rng.uniform(0.0, 0.3))
            soaked.known[name](soaked, rng)
        end = await _outcome(job)
        ended_s = time.monotonic() - began_s
        count.moves += 1
        count.faults[name] = count.faults.get(name, 0) + 1
        count.longest_end_s = max(count.longest_end_s, ended_s)
        count.beyond_time_outs += ended_s > MOVE_END_S
        self._judge(end, target, len(soaked.begun_s) - before)
        await self._stand()
        soaked.heal()
        await self._release()
        count.doubled += max(0, len(soaked.begun_s) - before - 1)
        self._judge_ages(aged)
        if not count.good and not count.wrong:
            count.wrong[count.moves] = name

    def _judge(self, end: RobotState | None, target: RigidTransform, begun: int) -> None:
        soaked, count = self._soaked, self._count
        if end is None:
            count.ended_early += 1
            return
        count.finished += 1
        flange = soaked.arm.encoder_pose(soaked.arm.standstill_s)
        off_m = float(np.linalg.norm(flange.translation - target.translation))
        if soaked.moving() or off_m > TOLERANCE_M or begun == 0:
            count.lost += 1

    def _judge_ages(self, first: int) -> None:
        allowed_s = STALE_S + self._soaked.begin_s + DELAY_S
        for age_s in self._soaked.ages_s[first:]:
            self._count.greatest_state_age_s = max(self._count.greatest_state_age_s, age_s)
            self._count.stale += age_s > allowed_s

    async def _stand(self) -> None:
        """Heartbeats that stay away stop the arm, whatever else is broken."""
        limit_s = time.monotonic() + MOVE_END_S
        while self._soaked.moving():
            if time.monotonic() > limit_s:
                self._count.beyond_time_outs += 1
                return
            await asyncio.sleep(0.005)

    async def _release(self) -> None:
        """Re-arm as an operator does: again until the link is back and the controller accepts."""
        began_s = time.monotonic()
        while time.monotonic() - began_s < REARM_S:
            try:
                await self._soaked.robot.connect()
                await self._soaked.robot.rearm()
                await self._fresh()
            except CellError:
                await asyncio.sleep(PAUSE_S)
            else:
                took_s = time.monotonic() - began_s
                self._count.longest_release_s = max(self._count.longest_release_s, took_s)
                return
        self._count.not_released += 1

    async def _fresh(self) -> None:
        """Wait until the state says so too; ``LinkError`` where it has no news."""
        for _ in range(40):
            if self._soaked.robot.state(STALE_S).ready:
                return
            await asyncio.sleep(PAUSE_S)
        raise LinkError("the state does not become ready")


async def _outcome(job: "asyncio.Task[RobotState]") -> RobotState | None:
    """Where it ended; None for one that ended early, or not at all within three times its time."""
    try:
        async with asyncio.timeout(3 * MOVE_END_S):
            return await job
    except (CellError, TimeoutError):
        return None


async def soak(
    way: Callable[[], AbstractAsyncContextManager[Soaked]], moves: int, seed: int
) -> Count:
    """One way to an arm."""
    count, rng, began_s = Count(), random.Random(seed), time.monotonic()
    async with way() as soaked:
        one = Soak(soaked, rng, count)
        for _ in range(moves):
            await one.move()
        count.begun_unlinked = soaked.unlinked
    count.fake_hours = (time.monotonic() - began_s) / 3600
    return count


def table(counts: dict[str, Count]) -> str:
    """The counts as a table of a document."""
    lines = [
        "| way | motions | finished | ended early | lost | doubled | on old state "
        "| beyond time-outs | not released | longest end, s | longest release, s "
        "| oldest state, s | fake hours |",
        "|---|" + "--:|" * 12,
    ]
    for name, one in counts.items():
        lines.append(
            f"| {name} | {one.moves} | {one.finished} | {one.ended_early} | {one.lost} "
            f"| {one.doubled} | {one.stale} | {one.beyond_time_outs} | {one.not_released} "
            f"| {one.longest_end_s:.2f} | {one.longest_release_s:.2f} "
            f"| {one.greatest_state_age_s:.3f} | {one.fake_hours:.1f} |"
        )
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    """Print the table; exit code 1 when anything happened that must not."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--moves", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--way", choices=sorted(WAYS), nargs="+", default=list(WAYS))
    parser.add_argument("--out", type=Path)
    options = parser.parse_args(arguments)
    counts: dict[str, Count] = {}
    # The lost links are what is tried here.
    logging.disable(logging.WARNING)
    try:
        for name in options.way:
            counts[name] = QuickTime().run(soak(WAYS[name], options.moves, options.seed))
    finally:
        logging.disable(logging.NOTSET)
    print(table(counts))
    if options.out is not None:
        options.out.parent.mkdir(parents=True, exist_ok=True)
        figures = {name: asdict(count) for name, count in counts.items()}
        options.out.write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")
    return 0 if all(count.good for count in counts.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
