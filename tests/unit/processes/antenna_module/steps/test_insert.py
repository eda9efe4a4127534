"""Step 80: pushed in once and judged; straight out after a fault, the curve kept, no second try."""

import asyncio
import importlib
import threading
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from cellctl.clock import now_s
from cellctl.errors.records.store import RecordNotWritten
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.antenna_module.faults.plugging import PlugShortSeat, StaleLook
from cellctl.processes.antenna_module.insertion.curve import InsertionCurve
from cellctl.processes.antenna_module.insertion.verdict import InsertionVerdict
from cellctl.processes.antenna_module.process import AntennaModule
from cellctl.processes.antenna_module.pushing.attempt import PushAttempt
from cellctl.processes.antenna_module.record import insertion as recorded
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.state import HeldModule, OverSocket
from tests.rigs.antenna import exact_cell as exact
from tests.unit.processes.antenna_module.pushing.contact import (
    SEATED,
    STAND_OFF_M,
    PlugWorld,
    Push,
    Wrench,
    good,
)
from tests.unit.processes.antenna_module.steps.bench import Bench

# By their names: the package offers the functions under the names of the modules.
step = importlib.import_module("cellctl.processes.antenna_module.steps.insert")
attempts = importlib.import_module("cellctl.processes.antenna_module.pushing.attempt")


def early_seat(depth_mm: float) -> tuple[float, ...]:
    """A foreign body of 0.3 mm lies in the socket."""
    felt = list(good(min(depth_mm, 2.4)))
    felt[2] += 400.0 * max(0.0, depth_mm - 2.2)
    return tuple(felt)


@dataclass
class Over:
    """A plug that hangs over its socket."""

    bench: Bench
    monkeypatch: pytest.MonkeyPatch
    wrench: Wrench = good
    pushes: list[Push] = field(default_factory=list)

    def state(self, *, looked_s_ago: float = 5.0) -> OverSocket:
        world = PlugWorld(self.wrench)

        @asynccontextmanager
        async def contact(_over: OverSocket) -> AsyncIterator[PushAttempt]:
            self.pushes.append(Push(world))
            async with self.pushes[-1] as attempt:
                yield attempt

        self.monkeypatch.setattr(step, "contact", contact)
        looks = exact.looks()
        for look in looks.all():
            object.__setattr__(look, "time_s", now_s() - looked_s_ago)
        plan: Any = UncertainPose(SEATED, exact.SEEN)
        return OverSocket(
            self.bench.run(), HeldModule(0.25, np.zeros(3), -0.16), plug=looks.plug,
            flange_T_connector=self.bench.flange_T_connector, looks=looks, plan=plan,
        )  # fmt: skip

    @property
    def world(self) -> PlugWorld:
        (push,) = self.pushes
        return push.world


@pytest.fixture
def over(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> Over:
    return Over(bench, monkeypatch)


async def test_a_good_plug_is_seated_and_its_curve_kept(over: Over) -> None:
    inserted = await step.insert(over.state())
    assert inserted.judgement.verdict is InsertionVerdict.SEATED
    notes = over.bench.notes
    assert notes.artefacts == [keys.CURVE]
    assert notes.documents[keys.INSERTION]["verdict"] == "seated"
    # Read off the curve, whose depths are those of an arm that jumps a tenth of a millimetre: on a
    # busy PC the recorder sees it between two jumps or after both.
    assert notes.figures[keys.SEAT_DEPTH] == pytest.approx(2.5, abs=0.16)
    assert over.world.depth_mm() == pytest.approx(2.5, abs=0.06)


async def test_a_seat_that_comes_early_ends_it_for_good(over: Over) -> None:
    over.wrench = early_seat
    with pytest.raises(PlugShortSeat) as raised:
        await step.insert(over.state())
    world, notes = over.world, over.bench.notes
    # Out to where it came from, and never again inwards.
    deepest = int(np.argmax(world.targets_mm))
    assert world.targets_mm[deepest] < 2.35
    assert world.depth_mm() == pytest.approx(-STAND_OFF_M * 1e3, abs=1e-6)
    assert np.all(np.diff(world.targets_mm[deepest:]) < 0)
    assert notes.artefacts == [keys.CURVE]
    assert notes.documents[keys.INSERTION]["fault"] == PlugShortSeat.number
    assert type(raised.value) in AntennaModule.spoiled_by


async def test_looks_that_have_grown_old_are_not_plugged_by(over: Over) -> None:
    with pytest.raises(StaleLook):
        await step.insert(over.state(looked_s_ago=61.0))
    assert over.pushes == []


async def test_what_is_cancelled_begins_no_other_move(over: Over) -> None:
    entered = asyncio.Event()

    def wrench(depth_mm: float) -> tuple[float, ...]:
        if depth_mm > -0.4:
            entered.set()
        return good(depth_mm)

    over.wrench = wrench
    task = asyncio.create_task(step.insert(over.state()))
    await asyncio.wait_for(entered.wait(), 10.0)
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await task
    assert np.all(np.diff(over.world.targets_mm) > 0)
    assert over.bench.notes.artefacts == [keys.CURVE]


async def test_a_disk_that_fails_does_not_hide_what_ended_the_insertion(over: Over) -> None:
    over.wrench = early_seat
    over.bench.notes.disk = RecordNotWritten("disk full")
    with pytest.raises(PlugShortSeat) as raised:
        await step.insert(over.state())
    assert any("insertion curve not kept" in note for note in raised.value.__notes__)


async def test_the_curve_is_written_out_beside_the_loop(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Meanwhile nothing would tell the robot that this PC lives."""
    threads: list[int] = []

    def written(_curve: InsertionCurve) -> str:
        threads.append(threading.get_ident())
        return "t_s"

    monkeypatch.setattr(recorded, "curve_text", written)
    empty = InsertionCurve(np.zeros(0), np.zeros(0), np.zeros((0, 3)), np.zeros((0, 3)))
    await recorded.record_curve(bench.run(), empty)
    assert threads
    assert threads[0] != threading.get_ident()


async def test_the_loop_runs_on_while_the_curve_is_judged(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    threads: list[int] = []
    judge = attempts.judge_insertion

    def judged(*given: Any) -> Any:
        threads.append(threading.get_ident())
        return judge(*given)

    monkeypatch.setattr(attempts, "judge_insertion", judged)
    await step.insert(Over(bench, monkeypatch).state())
    assert threads
    assert threading.get_ident() not in threads
