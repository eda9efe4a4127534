"""What a first contact leads to, on streamed contact with an elastic part."""

import asyncio

import numpy as np
import pytest

from cellctl.force.contact.streamed.gains import LoopFigures
from cellctl.processes.peg_in_hole.faults import WrongFeature
from cellctl.processes.peg_in_hole.first_contact.classify import ContactClass
from cellctl.processes.peg_in_hole.first_contact.reactions import Contacts, meet_face, require_walls
from cellctl.processes.peg_in_hole.plan.parameters import search_parameters
from tests.unit.cell.contact_motion.elastic_world import (
    Array,
    ElasticWorld,
    Hole,
    Part,
    contact,
    wall,
)
from tests.unit.processes.peg_in_hole.tasks import pin

STIFFNESS_N_M = 1e5
CLEARANCE_M = 0.1e-3


def slot(tip: Array) -> Array:
    """Walls along x only; along y nothing stands."""
    return Hole(STIFFNESS_N_M, clearance_m=CLEARANCE_M)(np.array([tip[0], 0.0, *tip[2:]]))


def beyond(tip: Array) -> Array:
    """The world beside a plug: nothing to any side, and a floor at 2 mm."""
    return wall(STIFFNESS_N_M)(tip - [0, 0, 2e-3, 0, 0, 0])


async def _classified(
    part: Part, at_m: tuple[float, float, float], *, entered: bool, stiffness_n_m: float
) -> Contacts:
    tip = np.array([*at_m, 0.0, 0.0, 0.0])
    world = ElasticWorld(part, sigma_n=0.1, tip=tip)
    task = pin(
        1e3 * CLEARANCE_M, chamfer_mm=0.5, stiffness_n_m=stiffness_n_m,
        dead_time_s=world.dead_time_s,
    )  # fmt: skip
    motions = contact(world, LoopFigures(stiffness_n_m, world.dead_time_s))
    contacts: Contacts = []
    look = require_walls if entered else meet_face
    await look(motions, task, search_parameters(task), contacts)
    return contacts


def classified(
    part: Part,
    at_m: tuple[float, float, float],
    *,
    entered: bool = False,
    stiffness_n_m: float = STIFFNESS_N_M,
) -> list[ContactClass]:
    looked = _classified(part, at_m, entered=entered, stiffness_n_m=stiffness_n_m)
    contacts = asyncio.run(looked)
    return [contact.found for contact in contacts]


def test_the_face_is_known_by_the_direction_of_its_force() -> None:
    assert classified(wall(STIFFNESS_N_M), (0.0, 0.0, 0.02e-3)) == [ContactClass.END_FACE]


def test_a_peg_on_a_chamfer_is_let_go_and_has_walls_all_round_then() -> None:
    hole = Hole(STIFFNESS_N_M, clearance_m=CLEARANCE_M, depth_m=2e-3)
    first, *rest = classified(hole, (0.3e-3, 0.0, 0.3e-3))
    assert first in (ContactClass.EDGE, ContactClass.SIDE)
    # Not aligned: so lightly pressed it is not as deep as the entry yet.
    assert rest == [ContactClass.STUCK, ContactClass.STUCK]


def test_behind_the_entry_of_its_hole_a_peg_has_walls_all_round() -> None:
    hole = Hole(STIFFNESS_N_M, clearance_m=CLEARANCE_M)
    assert classified(hole, (0.0, 0.0, 1.5e-3), entered=True) == [ContactClass.ALIGNED]


def test_a_stiff_arm_gives_way_along_all_of_a_chamfer_within_one_try() -> None:
    stiff = Hole(1e6, clearance_m=CLEARANCE_M, chamfer_m=1e-3, depth_m=2e-3)
    looked = _classified(stiff, (0.8e-3, 0.0, 0.3e-3), entered=False, stiffness_n_m=1e6)
    on_flank, let_go, *_ = asyncio.run(looked)
    assert on_flank.found in (ContactClass.EDGE, ContactClass.SIDE)
    # Within its clearance of the axis of the hole, but for the noise.
    across_m = np.hypot(*let_go.sample.task_position_tip_m[:2])
    assert across_m == pytest.approx(CLEARANCE_M, abs=0.02e-3)


@pytest.mark.parametrize(
    ("part", "words"), [(slot, "two opposite sides only"), (beyond, "nothing resists")]
)
def test_what_is_no_round_hole_is_a_fault_before_anything_is_fed_into_it(
    part: Part, words: str
) -> None:
    with pytest.raises(WrongFeature, match=f"F598.*{words}"):
        classified(part, (0.0, 0.0, 1.9e-3), entered=True)
