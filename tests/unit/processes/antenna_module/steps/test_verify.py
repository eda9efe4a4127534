"""Step 90: pulled, released, and seen where it was left: offset, turn and gap."""

import importlib
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.errors.gripper import PartLost
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.antenna_module.chain.looks import Looks, PlugLook
from cellctl.processes.antenna_module.faults.connector import MarksMissing
from cellctl.processes.antenna_module.faults.plugging import MovedOnRelease, PlugNotHeld
from cellctl.processes.antenna_module.process import AntennaModule
from cellctl.processes.antenna_module.pushing.attempt import PushAttempt
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.record.required import required_figures
from cellctl.processes.antenna_module.report.acceptance import _GROUPS
from cellctl.processes.antenna_module.state import Inserted, PlugInspected
from cellctl.processes.antenna_module.steps.contact import limits_of
from tests.unit.processes.antenna_module.pushing.contact import PlugWorld, Push, Wrench
from tests.unit.processes.antenna_module.steps.bench import TAUGHT, Bench, nothing_swings
from tests.unit.processes.antenna_module.steps.test_grip_again import picked

# Modules are named by text, because the package offers the functions under the same names.
STEPS = "cellctl.processes.antenna_module.steps"
verify, inspect, locate, plan = (
    importlib.import_module(f"{STEPS}.{name}")
    for name in ("verify", "inspect_plug", "locate_socket", "plan")
)
PRESSED_MM = 0.06
"""How far fingers and arm give way to the force with which the seat was felt."""


def held(depth_mm: float) -> tuple[float, ...]:
    """Contacts that hold: a spring of 400 N/mm about where the plug sits."""
    return (0.0, 0.0, 400.0 * (depth_mm - 2.5), 0.0, 0.0, 0.0)


def loose(depth_mm: float) -> tuple[float, ...]:
    """Nothing holds: what was pressed comes off, and the plug follows."""
    return (0.0, 0.0, max(0.0, held(depth_mm)[2]), 0.0, 0.0, 0.0)


@dataclass
class Plugged:
    """A module in its socket, still held; what becomes of it when it is released."""

    bench: Bench
    monkeypatch: pytest.MonkeyPatch
    wrench: Wrench = held
    rises_mm: float = 0.0
    slips_mm: float = 0.0
    turns_deg: float = 0.0
    worlds: list[PlugWorld] = field(default_factory=list)

    async def inserted(self, **changes: object) -> Inserted:
        bench = self.bench
        seen: PlugInspected = await inspect.inspect_plug(self._picked(**changes))
        done = await plan.plan(await locate.locate_socket(seen))
        looks: Looks = done.looks
        assert isinstance(looks.plug, PlugLook)
        seated = done.plan.base_T_flange.pose
        world = PlugWorld(self.wrench)
        self.worlds.append(world)

        @asynccontextmanager
        async def contact(_over: object) -> AsyncIterator[PushAttempt]:
            async with Push(world) as attempt:
                world.way = attempt.way = type(world.way)(
                    seated, world.way.outwards, world.seat_depth_m
                )
                world.go(world.way.pose_at(2.5e-3 + PRESSED_MM * MM))
                yield attempt

        self.monkeypatch.setattr(verify, "contact", contact)
        # The plug sits where the arm holds it without pressing.
        bench.base_T_flange = world.way.pose_at(2.5e-3)
        self.monkeypatch.setattr(bench, "open", self._opened(seated))
        return Inserted(
            done.run, done.module, plug=done.plug, flange_T_connector=done.flange_T_connector,
            looks=looks, plan=done.plan, judgement=_NONE,
        )  # fmt: skip

    def _picked(self, **changes: object) -> Any:
        state = picked(self.bench)
        top_m = (self.bench.connector_now() * self.bench.connector_T_top).translation[2]
        object.__setattr__(
            state.module, "top_over_flange_m", top_m - TAUGHT["inspect_plug"].translation[2]
        )
        object.__setattr__(state, "run", self.bench.run(**changes))
        return state

    def _opened(self, seated: RigidTransform) -> Any:
        async def opened() -> None:
            self.bench.events.append("open")
            self.bench.seated(seated)
            moved = pose_from_xyzabc((self.slips_mm, 0.0, self.rises_mm, self.turns_deg, 0.0, 0.0))
            place = RigidTransform.from_translation(self.bench.base_T_connector.translation)
            self.bench.base_T_connector = place * moved * place.inv() * self.bench.base_T_connector

        return opened


_NONE: Any = None


@pytest.fixture
def plugged(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> Plugged:
    nothing_swings(monkeypatch)
    return Plugged(bench, monkeypatch)


async def test_a_module_that_stays_is_good(plugged: Plugged) -> None:
    state = await plugged.inserted()
    begun = len(plugged.bench.events)
    await verify.verify(state)
    assert plugged.bench.events[begun:] == [
        "part?", "open", "slowly", "move", "move", "look released",
    ]  # fmt: skip
    figures = plugged.bench.notes.figures
    assert figures[keys.PULL] >= 2.0
    # What was pressed comes off first, then contacts give way by a few micrometres.
    assert figures[keys.PULL_TRAVEL] == pytest.approx(PRESSED_MM + 0.02, abs=0.011)
    assert figures[keys.PLACED] == pytest.approx(0.0, abs=2e-3)
    assert figures[keys.PLACED_TURN] == pytest.approx(0.0, abs=0.01)
    assert figures[keys.GAP] == pytest.approx(0.0, abs=5e-3)
    asked = {one.figure.key for one in required_figures(state.run, limits_of(state.run))}
    at_the_push = {keys.SEAT_DEPTH, keys.TOTAL, keys.SIDE, keys.MOMENT_Z}
    assert asked - at_the_push - {keys.MASS} <= set(figures), "weighed when it was picked"
    titled = {key for _, _, titles in _GROUPS for key in titles}
    assert asked == titled, "each has its line in the acceptance record"


async def test_a_pull_is_no_longer_than_the_recipe_allows(plugged: Plugged) -> None:
    """A step more would be a figure beyond its limit in the record of a good part."""
    insertion = plugged.bench.recipe.insertion.model_copy(update={"pull_travel_mm": 0.05})
    state = await plugged.inserted(insertion=insertion)
    with pytest.raises(PlugNotHeld, match=r"after 0\.05 mm"):
        await verify.verify(state)
    assert min(plugged.worlds[0].targets_mm) == pytest.approx(2.5 + PRESSED_MM - 0.05)


async def test_a_plug_that_follows_the_pull_is_not_released(plugged: Plugged) -> None:
    plugged.wrench = loose
    state = await plugged.inserted()
    with pytest.raises(PlugNotHeld, match=r"after 0\.20 mm, wanted 2 N"):
        await verify.verify(state)
    assert "open" not in plugged.bench.events
    assert PlugNotHeld in AntennaModule.spoiled_by


@pytest.mark.parametrize("wrench", [held, loose])
async def test_a_module_that_the_jaws_have_lost_is_no_bad_plug(
    plugged: Plugged, wrench: Wrench
) -> None:
    plugged.wrench = wrench
    state = await plugged.inserted()
    plugged.bench.lost = True
    with pytest.raises(PartLost):
        await verify.verify(state)
    # Nor is it taken for one that was let go in its socket.
    assert "open" not in plugged.bench.events
    assert PartLost not in AntennaModule.spoiled_by


@pytest.mark.parametrize(
    ("moved", "key", "shown", "words"),
    [
        ({"slips_mm": 0.15}, keys.PLACED, 0.15, "0.150 mm from its place"),
        ({"turns_deg": 0.8}, keys.PLACED_TURN, 0.8, r"turned by .0\.80°"),
        ({"rises_mm": 0.15}, keys.GAP, 0.15, r"\+0\.1\d\d mm over its seat"),
        ({"rises_mm": -0.15}, keys.GAP, -0.15, r"-0\.1\d\d mm over its seat"),
    ],
    ids=["offset", "turn", "gap", "below its seat"],
)
async def test_a_module_that_moves_on_release_is_bad(
    plugged: Plugged, moved: dict[str, float], key: str, shown: float, words: str
) -> None:
    for name, value in moved.items():
        setattr(plugged, name, value)
    state = await plugged.inserted()
    with pytest.raises(MovedOnRelease, match=words):
        await verify.verify(state)
    assert abs(plugged.bench.notes.figures[key]) == pytest.approx(abs(shown), abs=0.005)
    # All three are in the record, whichever of them was beyond its limit.
    assert {keys.PLACED, keys.PLACED_TURN, keys.GAP} <= plugged.bench.notes.figures.keys()
    assert MovedOnRelease in AntennaModule.spoiled_by


async def test_what_the_gap_always_reads_in_a_cell_is_taken_off(plugged: Plugged) -> None:
    plugged.rises_mm = 0.15
    await verify.verify(await plugged.inserted(gap_zero_mm=0.12))
    assert plugged.bench.notes.figures[keys.GAP] == pytest.approx(0.03, abs=5e-3)


async def test_a_module_that_is_not_seen_has_moved_after_a_second_look(plugged: Plugged) -> None:
    state = await plugged.inserted()
    plugged.bench.spoilt = {
        "released": [MarksMissing("1 spot")], "released-again": [MarksMissing("0 spots")],
    }  # fmt: skip
    with pytest.raises(MovedOnRelease, match=r"not seen in its place: .*0 spots"):
        await verify.verify(state)


@pytest.mark.parametrize(
    ("readings", "depth_mm"),
    [
        ([(2.56, 24.0), (2.54, 16.0), (2.52, 8.0), (2.50, 0.0), (2.48, -8.0)], 2.50),
        ([(2.52, 6.0), (2.50, -2.0)], 2.505),
        ([(2.50, -0.5), (2.48, -3.0)], 2.50),
        # What gives way after that is a plug that comes out.
        ([(2.52, 8.0), (2.50, 0.0), (2.40, 0.1), (2.38, -3.0)], 2.50),
    ],
)
def test_the_seat_is_where_the_force_is_nothing(
    readings: list[tuple[float, float]], depth_mm: float
) -> None:
    at = verify.free_depth_m([(depth * MM, force_n) for depth, force_n in readings])
    assert at == pytest.approx(depth_mm * MM, abs=1e-9)
    assert np.isfinite(at)
