"""Every strategy on the kinematic model: few seeds here, figures in ``make campaign-insertion``."""

import asyncio
from typing import cast

import numpy as np
import pytest
from numpy.typing import NDArray

from cellctl.cell.contact_motion.motions import ContactMotion
from cellctl.processes.peg_in_hole.faults import HoleAbsent, SearchGaveUp
from cellctl.processes.peg_in_hole.plan.choice import SearchName, choose_search
from cellctl.processes.peg_in_hole.plan.parameters import search_parameters
from cellctl.processes.peg_in_hole.plan.task import SearchTask
from cellctl.processes.peg_in_hole.search.find_hole import STRATEGIES, find_hole
from cellctl.processes.peg_in_hole.search.hole_map import HoleMap
from cellctl.processes.peg_in_hole.search.probe import Felt, TouchProbe
from cellctl.processes.peg_in_hole.search.strategy import SearchStrategy
from tests.rigs.insertion.kinematic import KinematicMotions
from tests.rigs.insertion.surface import Truth
from tests.unit.processes.peg_in_hole.tasks import pin, plug

Array = NDArray[np.float64]


def searching(
    task: SearchTask, seed: int, *, absent: bool = False, deadline_s: float = 120.0
) -> tuple[TouchProbe, KinematicMotions]:
    rng = np.random.default_rng(seed)
    drawn = Truth.draw(task, rng)
    truth = Truth(drawn.hole_m, drawn.slope, absent)
    motions = KinematicMotions(task, truth, rng)
    hole_map = HoleMap(task.cell.uncertainty_m, task.fit.catch_radius_m)
    return TouchProbe(motions, task, search_parameters(task), hole_map, deadline_s), motions


@pytest.mark.parametrize(
    ("name", "task", "least"),
    [
        (SearchName.SPIRAL, plug(), 10),
        (SearchName.SPIRAL, pin(chamfer_mm=0.5), 10),
        (SearchName.TILTED_VALLEY, pin(), 9),
        pytest.param(
            SearchName.TILTED_VALLEY, pin(stiffness_n_m=1e5), 9, marks=pytest.mark.figures
        ),
        pytest.param(SearchName.PARTICLE_MAP, pin(stiffness_n_m=1e5), 8, marks=pytest.mark.long),
        (SearchName.ARC, plug(0.05, chamfer_mm=0), 8),
        (SearchName.PATENT_CIRCUMCENTRE, plug(), 9),
    ],
)
def test_a_strategy_finds_the_hole_and_stands_in_it(
    name: SearchName, task: SearchTask, least: int
) -> None:
    found = 0
    for seed in range(10):
        probe, motions = searching(task, seed)
        try:
            entered = asyncio.run(STRATEGIES[name].find(probe))
        except SearchGaveUp:
            continue
        off_m = float(np.hypot(*motions.true_offset_m))
        # Whatever it says, it says of the hole.
        assert entered == (off_m < task.fit.catch_radius_m)
        found += entered
    assert found >= least


class Beside(KinematicMotions):
    """Remembers how near its free ways have come to the axis of a plug below its face."""

    nearest_m = np.inf

    async def move_free(
        self, task_position_tip_m: Array, task_rotation_tip_rad: Array, speed_m_s: float
    ) -> ContactMotion:
        way = np.linspace(self.position_m, task_position_tip_m, 101)
        below = way[way[:, 2] > 1e-3]
        from_axis_m = np.hypot(*(below[:, :2] - self.truth.hole_m).T)
        self.nearest_m = float(np.min(from_axis_m, initial=self.nearest_m))
        return await super().move_free(task_position_tip_m, task_rotation_tip_rad, speed_m_s)


@pytest.mark.parametrize("seed", range(5))
def test_ways_along_a_plug_go_round_it(seed: int) -> None:
    """A straight one between two touches would end at its side."""
    task = plug(0.05, chamfer_mm=0)
    rng = np.random.default_rng(seed)
    motions = Beside(task, Truth.draw(task, rng), rng)
    hole_map = HoleMap(task.cell.uncertainty_m, task.fit.catch_radius_m)
    probe = TouchProbe(motions, task, search_parameters(task), hole_map, 120.0)
    asyncio.run(STRATEGIES[SearchName.ARC].find(probe))
    touched_m = 0.2e-3  # what encoders and readings are off
    assert motions.nearest_m > (task.fit.rim_m or 0.0) - touched_m


class FindsNothing(SearchStrategy):
    """Has looked at the half of the map in which the hole is not."""

    name = SearchName.ARC

    async def find(self, probe: TouchProbe) -> bool:
        points_m = probe.hole_map.points_m
        probe.hole_map.rule_out(points_m[points_m[..., 0] < 0.4e-3])
        return False


@pytest.mark.parametrize(("hole_mm", "found"), [(1.2, True), (-5.0, False)])
def test_what_the_map_has_left_is_looked_at_once_more(
    hole_mm: float, *, found: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    task = pin(0.1, chamfer_mm=0.5)
    truth = Truth(np.array([hole_mm * 1e-3, 0.0]), np.zeros(2))
    motions = KinematicMotions(task, truth, np.random.default_rng(1))
    hole_map = HoleMap(task.cell.uncertainty_m, task.fit.catch_radius_m)
    probe = TouchProbe(motions, task, search_parameters(task), hole_map, 120.0)
    monkeypatch.setitem(
        cast(dict[SearchName, SearchStrategy], STRATEGIES), SearchName.ARC, FindsNothing()
    )
    if found:
        assert asyncio.run(find_hole(probe, (SearchName.ARC,))) is SearchName.SPIRAL
    else:
        with pytest.raises(HoleAbsent, match="likeliest place of the rest"):
            asyncio.run(find_hole(probe, (SearchName.ARC,)))
    assert probe.trace.points, "it has looked"


def test_without_a_hole_a_spiral_searches_the_whole_map() -> None:
    task = plug(uncertainty_m=2e-3)
    probe, _ = searching(task, 1, absent=True, deadline_s=500.0)
    with pytest.raises(HoleAbsent, match="in the whole map"):
        asyncio.run(find_hole(probe, (SearchName.SPIRAL,)))
    assert all(point.felt is not Felt.ENTRY for point in probe.trace.points)


def test_every_search_ends_at_its_deadline() -> None:
    probe, motions = searching(pin(), 2, absent=True, deadline_s=30.0)
    with pytest.raises(SearchGaveUp):
        asyncio.run(find_hole(probe, choose_search(pin()).order))
    assert motions.time_s < 30 + 25  # one motion may run beyond it


def test_the_next_strategy_follows_when_the_first_finds_nothing() -> None:
    task = plug(0.05, chamfer_mm=0, uncertainty_m=2e-3)
    probe, motions = searching(task, 3)
    order = (SearchName.PATENT_MIDPOINT, SearchName.PATENT_CIRCUMCENTRE)
    assert asyncio.run(find_hole(probe, order)) is SearchName.PATENT_CIRCUMCENTRE
    assert np.hypot(*motions.true_offset_m) < task.fit.catch_radius_m


class Lifting(KinematicMotions):
    """Remembers how high it was lifted last."""

    height_m = 0.0

    async def back_out(self, height_m: float) -> ContactMotion:
        self.height_m = height_m
        return await super().back_out(height_m)


def test_the_low_side_of_a_peg_that_leant_clears_the_face_before_it_stands_up() -> None:
    task = pin()
    rng = np.random.default_rng(1)
    motions = Lifting(task, Truth.draw(task, rng), rng)
    hole_map = HoleMap(task.cell.uncertainty_m, task.fit.catch_radius_m)
    probe = TouchProbe(motions, task, search_parameters(task), hole_map, 120.0)
    tilt_rad = probe.parameters.tilt.value
    low_m = task.fit.peg_radius_m * np.sin(tilt_rad)

    async def touch_twice() -> None:
        await probe.touch_down(np.zeros(2), np.array([0.0, tilt_rad, 0.0]), -low_m)
        await probe.touch_down(np.zeros(2), np.zeros(3))
        assert motions.height_m > low_m
        await probe.touch_down(np.zeros(2), np.zeros(3))
        assert motions.height_m < low_m

    asyncio.run(touch_twice())
