"""A press over the hole, on streamed contact with an elastic part."""

import asyncio

import numpy as np
import pytest

from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.force.contact.streamed.gains import LoopFigures
from cellctl.processes.peg_in_hole.first_contact.classify import ContactClass
from cellctl.processes.peg_in_hole.plan.choice import SearchName
from cellctl.processes.peg_in_hole.plan.parameters import search_parameters
from cellctl.processes.peg_in_hole.search.conditions import against_a_wall
from cellctl.processes.peg_in_hole.search.find_hole import find_hole
from cellctl.processes.peg_in_hole.search.hole_map import HoleMap
from cellctl.processes.peg_in_hole.search.probe import UPRIGHT, Felt, TouchProbe
from tests.unit.cell.contact_motion.elastic_world import ElasticWorld, Hole, Part, contact, wall
from tests.unit.processes.peg_in_hole.tasks import pin

CLEARANCE_M = 0.05e-3
NEVER_S = 1e9
_STIFF = pytest.param(1e6, marks=pytest.mark.figures)
"""Ten times as stiff is ten times as slow, and one press of a stiff cell is always tested."""


def probe_in(world: ElasticWorld, stiffness_n_m: float, chamfer_mm: float) -> TouchProbe:
    theta_s = world.dead_time_s
    task = pin(0.05, chamfer_mm=chamfer_mm, stiffness_n_m=stiffness_n_m, dead_time_s=theta_s)
    motions = contact(world, LoopFigures(stiffness_n_m, theta_s))
    hole_map = HoleMap(2e-3, task.fit.catch_radius_m)
    return TouchProbe(motions, task, search_parameters(task), hole_map, NEVER_S)


def standing_in(part: Part, *, at_m: tuple[float, float, float]) -> ElasticWorld:
    tip = np.array([*at_m, 0.0, 0.0, 0.0])
    return ElasticWorld(
        part, period_s=8e-3, delay_ticks=1, lag_s=5e-3, sigma_n=0.2, sigma_n_m=0.005, tip=tip
    )


def hole(stiffness_n_m: float, chamfer_mm: float) -> Hole:
    chamfer_m = max(chamfer_mm, 1e-3) * 1e-3
    return Hole(stiffness_n_m, clearance_m=CLEARANCE_M, chamfer_m=chamfer_m, depth_m=12e-3)


@pytest.mark.parametrize(
    ("stiffness_n_m", "chamfer_mm", "depth_mm"),
    # Each two of them meet once; the standard test has each value of each.
    [
        (1e5, 0.0, -0.02),
        (2e5, 0.5, 0.2),
        (1e6, 0.5, 0.0),
        *(
            pytest.param(*values, marks=pytest.mark.figures)
            for values in (
                (1e5, 0.5, 0.0),
                (1e5, 0.0, 0.2),
                (2e5, 0.5, -0.02),
                (2e5, 0.0, 0.0),
                (1e6, 0.0, -0.02),
                (1e6, 0.5, 0.2),
            )
        ),
    ],
)
def test_a_peg_free_over_its_hole_enters_however_stiff_the_cell_is(
    stiffness_n_m: float, chamfer_mm: float, depth_mm: float
) -> None:
    world = standing_in(hole(stiffness_n_m, chamfer_mm), at_m=(0, 0, depth_mm * 1e-3))
    probe = probe_in(world, stiffness_n_m, chamfer_mm)
    begun_s = world.now_s
    assert asyncio.run(probe.enters())
    assert world.tip[2] >= probe.task.fit.entry_depth_m
    assert probe.trace.points[-1].felt is Felt.ENTRY
    assert world.now_s - begun_s < probe.parameters.entry_time.value


@pytest.mark.parametrize("stiffness_n_m", [1e5, _STIFF])
def test_a_peg_that_stands_in_the_mouth_is_not_lifted_out_of_it(stiffness_n_m: float) -> None:
    # The search centre lies beside the hole, and nothing there would be found within its map.
    mouth = Hole(stiffness_n_m, np.array([9e-3, 0.0]), CLEARANCE_M, chamfer_m=1e-3, depth_m=12e-3)
    world = standing_in(mouth, at_m=(9.3e-3, 0.0, 0.7e-3))
    probe = probe_in(world, stiffness_n_m, 0.5)
    order = (SearchName.SPIRAL,)
    found_by = asyncio.run(find_hole(probe, order, first_contact=ContactClass.STUCK))
    assert found_by is SearchName.SPIRAL
    assert world.tip[0] == pytest.approx(9e-3, abs=0.2e-3)
    assert not any(tip[2] < 0.0 for tip in world.sent)


def test_a_mouth_that_lets_nothing_in_is_left_and_not_pressed_again_and_again() -> None:
    # The bore is narrower than the peg, and lies on the first turn of the spiral.
    narrow = Hole(3e5, np.array([-0.76e-3, 0.0]), -0.1e-3, chamfer_m=0.6e-3, depth_m=12e-3)
    world = standing_in(narrow, at_m=(0.0, 0.0, -0.1e-3))
    probe = probe_in(world, 3e5, 0.5)

    async def search() -> bool:
        await probe.touch_down(np.zeros(2), UPRIGHT)
        return await probe.spiral(np.zeros(2), 1.5e-3)

    assert not asyncio.run(search())
    assert [point.felt for point in probe.trace.points].count(Felt.EDGE) <= 2
    # The turn goes on to its end.
    assert np.linalg.norm(world.tip[:2]) == pytest.approx(1.5e-3, abs=0.1e-3)
    assert greatest_n(world) < 1.5 * probe.press_n


def test_a_touch_goes_down_as_fast_as_its_force_may_grow_by_a_whole_press() -> None:
    world = standing_in(wall(1e6), at_m=(0.0, 0.0, -1e-3))
    probe = probe_in(world, 1e6, 0.0)
    begun_s = world.now_s
    asyncio.run(probe.touch_down(np.zeros(2), UPRIGHT))
    way_s = 0.3e-3 / probe.parameters.touch_speed.value
    # Half a second for lift and way over the point.
    assert way_s < world.now_s - begun_s < way_s + 0.5
    assert greatest_n(world) < 1.5 * probe.press_n


@pytest.mark.parametrize("stiffness_n_m", [1e5, _STIFF])
def test_a_peg_on_the_chamfer_slides_in_when_it_is_let_go(stiffness_n_m: float) -> None:
    # The contact is lost where the chamfer ends, which is the way in and no fault.
    world = standing_in(hole(stiffness_n_m, 0.5), at_m=(0.25e-3, 0.0, 0.3e-3))
    assert asyncio.run(probe_in(world, stiffness_n_m, 0.5).enters())


def test_a_peg_on_the_chamfer_is_known_by_its_side_force_too() -> None:
    # The touches had pressed the face in by 0.3 mm: by its depth the peg stands on the face.
    believed_m = 0.3e-3
    part, sunk = hole(1e5, 0.5), np.array([0, 0, believed_m, 0, 0, 0])
    world = standing_in(lambda tip: part(tip + sunk), at_m=(0.25e-3, 0.0, 0.0))
    assert asyncio.run(probe_in(world, 1e5, 0.5).enters())


@pytest.mark.parametrize("stiffness_n_m", [1e5, 1e6])
def test_a_peg_that_the_face_carries_is_not_pressed_for_longer(stiffness_n_m: float) -> None:
    world = standing_in(wall(stiffness_n_m), at_m=(0.0, 0.0, -0.02e-3))
    probe = probe_in(world, stiffness_n_m, 0.5)
    begun_s = world.now_s
    assert not asyncio.run(probe.enters())
    assert probe.trace.points[-1].felt is Felt.FACE
    assert world.now_s - begun_s < 2.0


def greatest_n(world: ElasticWorld) -> float:
    """True force at any tick, all directions."""
    return max(float(np.linalg.norm(force[:3])) for force in world.forces)


@pytest.mark.parametrize("stiffness_n_m", [1e5, _STIFF])
def test_a_peg_on_the_chamfer_is_let_go_before_side_and_press_add_up(stiffness_n_m: float) -> None:
    # A stiff arm that presses down a chamfer of 45 degrees is pushed as hard from the side.
    world = standing_in(hole(stiffness_n_m, 0.5), at_m=(0.45e-3, 0.0, 0.05e-3))
    probe = probe_in(world, stiffness_n_m, 0.5)
    assert asyncio.run(probe.enters())
    assert greatest_n(world) < 1.2 * probe.press_n


def test_a_slide_out_of_a_chamfer_ends_at_its_wall_and_the_peg_enters() -> None:
    # The press of the touch has brought the peg onto the chamfer: nothing tells of a lost face.
    world = standing_in(hole(1e5, 0.5), at_m=(0.3e-3, 0.0, 0.24e-3))
    probe = probe_in(world, 1e5, 0.5)
    assert asyncio.run(probe.spiral(np.array([0.3e-3, 0.0]), 2e-3))
    assert greatest_n(world) < 1.2 * probe.press_n


@pytest.mark.parametrize(
    ("force_n", "held_by_a_wall"),
    [
        ((1.6, 0.0, -8.0), False),
        ((0.0, -5.0, -8.0), True),
        ((0.0, 5.0, -1.0), False),
        ((2.0, 0.0, -3.0), False),
    ],
    ids=["friction of the face", "chamfer", "guided by its bore", "too little to tell"],
)
def test_what_carries_and_pushes_sideways_is_a_wall(
    force_n: tuple[float, float, float], held_by_a_wall: bool
) -> None:
    zero = np.zeros(3)
    sample = ContactSample(0.0, zero, zero, np.array(force_n), zero, 0.2)
    assert against_a_wall(8.0, pin().cell)(sample) is held_by_a_wall
