"""The three ways to an arm that are soaked: its driver, its fake controller, the wires between."""

import random
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Any

from cellctl.errors.base import CellError
from cellctl.interfaces.robot import Robot
from fakes.faults import FaultBoard
from fakes.world.robot import RobotArm
from tests.rigs.wire.duco_rig import duco_rig
from tests.rigs.wire.job_rig import job_rig
from tests.rigs.wire.proxy import Chaos, ChaosProxy
from tests.rigs.wire.sjl_rig import sjl_rig

STATEMENT_S = 0.001
DELAY_S = 0.05
MOVE_TIMEOUT_S = 3.0
Inject = Callable[["Soaked", random.Random], object]


@dataclass
class Soaked:
    """One arm; ``begun_s`` are the times at which its world has begun a motion."""

    robot: Robot
    arm: RobotArm
    wires: list[ChaosProxy]
    faults: FaultBoard
    moving: Callable[[], bool]
    revive: Callable[[], None]
    """What a person does at the pendant when a job has ended in an alarm."""
    begin_s: float
    """Longest time from a command to its motion without faults: that of the job program."""
    known: dict[str, Inject]
    """What can go wrong."""
    begun_s: list[float] = field(default_factory=list)
    ages_s: list[float] = field(default_factory=list)
    """Age of the newest state that the driver had, at each of these but the unlinked ones."""
    unlinked: int = 0
    """Motions that began when the driver had just reported the loss of its link: their command had
    left before. The controller stops them."""

    def heal(self) -> None:
        """End all faults."""
        for wire in self.wires:
            if wire.forth.blocked or wire.back.blocked:
                # No TCP goes on behind bytes that it has lost: it repeats them or ends.
                wire.reset()
            for way in (wire.forth, wire.back):
                way.blocked = way.split = False
                way.delay_s, way.corrupt_in = 0.0, None
        self.faults.clear()
        self.revive()

    def watch(self, now_s: Callable[[], float]) -> None:
        """Note every motion that the arm begins from now on."""
        begin = self.arm.start_linear

        def noted(*arguments: Any) -> None:
            begin(*arguments)
            self.begun_s.append(now_s())
            try:
                self.ages_s.append(now_s() - self.robot.state(1e9).time_s)
            except CellError:
                self.unlinked += 1

        self.arm.start_linear = noted  # type: ignore[method-assign, assignment]


def _one(soaked: Soaked, rng: random.Random) -> ChaosProxy:
    return rng.choice(soaked.wires)


def _reset_all(soaked: Soaked) -> None:
    for wire in soaked.wires:
        wire.reset()


def _way(soaked: Soaked, rng: random.Random) -> Chaos:
    """One direction of one wire."""
    wire = _one(soaked, rng)
    return rng.choice([wire.forth, wire.back])


def _spoil(soaked: Soaked, rng: random.Random) -> None:
    _way(soaked, rng).corrupt_in = rng.randrange(400)


def _inject(name: str, **parameters: Any) -> Inject:
    return lambda soaked, _: soaked.faults.inject(name, **parameters)


_WIRE: dict[str, Inject] = {
    "none": lambda _soaked, _rng: None,
    "all connections reset": lambda soaked, _: _reset_all(soaked),
    "one wire reset": lambda soaked, rng: _one(soaked, rng).reset(),
    "half open": lambda s, rng: setattr(_way(s, rng), "blocked", True),
    "byte by byte": lambda s, rng: setattr(_way(s, rng), "split", True),
    "late": lambda s, rng: setattr(_way(s, rng), "delay_s", DELAY_S),
    "controller silent": _inject("silent"),
}
_KEY = {"key turned": _inject("manual_mode")}
_SJL = _WIRE | _KEY | {
    "bit flipped": _spoil,
    "no answer to a command": _inject("never_ack", count=1),
    "no end of a motion": _inject("never_done", count=1),
    "state frozen": _inject("frozen_stat"),
    "clock jumps": _inject("clock_jump"),
    "emergency stop": _inject("emergency_stop"),
}  # fmt: skip
_RPC = _WIRE | _KEY | {
    # Only replies are changed: with another bit a call may become another call, and nobody can
    # know, since the service has no check sum.
    "bit flipped": lambda s, rng: setattr(_one(s, rng).back, "corrupt_in", rng.randrange(400)),
    "state frames stop": _inject("frames_stop"),
    "motion answered with -1": _inject("minus_one", count=1),
    "emergency stop": _inject("emergency_stop"),
}  # fmt: skip


@asynccontextmanager
async def sjl() -> AsyncIterator[Soaked]:
    """Controller of an SR arm as the text of SJL/1 says."""
    async with sjl_rig(move_timeout_s=MOVE_TIMEOUT_S) as rig:
        await rig.connect()
        wires, board = list(rig.wires.values()), rig.controller.faults
        yield Soaked(
            rig.robot, rig.arm, wires, board, rig.controller.moving, lambda: None, 0.02, _SJL
        )


@asynccontextmanager
async def jobs() -> AsyncIterator[Soaked]:
    """The same arm with the shipped job files."""
    async with job_rig(statement_s=STATEMENT_S, move_timeout_s=MOVE_TIMEOUT_S) as rig:
        await rig.connect()

        def revive() -> None:
            if rig.controller.alarm:
                rig.controller.acknowledge()

        wires, board = list(rig.wires.values()), rig.controller.faults
        yield Soaked(rig.robot, rig.arm, wires, board, rig.controller.moving, revive, 0.25, _SJL)


@asynccontextmanager
async def rpc() -> AsyncIterator[Soaked]:
    """A collaborative arm over its remote interface."""
    async with duco_rig(move_timeout_s=MOVE_TIMEOUT_S) as rig:
        await rig.robot.connect()
        wires, board = [rig.rpc, rig.frames], rig.logic.faults
        yield Soaked(rig.robot, rig.arm, wires, board, rig.logic.moving, lambda: None, 0.02, _RPC)


WAYS = {"sjl": sjl, "jobs": jobs, "rpc": rpc}
