"""A deck that was left in the gripper is told by its weight, before anything swings through."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cellctl.geometry.pose import Array
from cellctl.processes.deck_to_frame.calibrations import PAYLOAD
from cellctl.processes.deck_to_frame.faults import DeckInGripper
from cellctl.processes.deck_to_frame.procedures.clear_cell import clear_the_cell
from cellctl.processes.deck_to_frame.procedures.empty_gripper import require_no_deck
from tests.unit.cell.bench import make_bench
from tests.unit.procedures.rig import ProcedureRig


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[ProcedureRig]:
    rig = ProcedureRig(make_bench(tmp_path), tmp_path / "store")
    yield rig
    rig.archive.close()


def hang(rig: ProcedureRig, other_n: Array) -> None:
    """The payload of procedure 106 on the sensor, and a force beside it, shape (3,)."""
    payload = rig.bench.calibrations.read(PAYLOAD).gravity_compensation
    arm = rig.bench.deck.arm
    rotation = arm.robot.state().base_T_flange.rotation * arm.flange_T_sensor.rotation
    rig.bench.cell.guard.raw += payload.load(rotation)
    rig.bench.cell.guard.raw[:, :3] += other_n


@pytest.mark.parametrize("number", [101, 102, 103, 109])
async def test_with_the_deck_gripped_the_procedure_ends_before_its_moves(
    rig: ProcedureRig, number: int
) -> None:
    await clear_the_cell(rig.bench.deck, rig.board)
    made = len(rig.bench.cell.main.moves)
    hang(rig, np.array([0.0, 0.0, 30.0]))
    with pytest.raises(DeckInGripper, match=r"reads the payload of procedure 106, .* 30 N"):
        await rig.procedures[number].run(rig.context)
    assert made == len(rig.bench.cell.main.moves)


async def test_without_the_weight_of_a_deck_it_goes_on(rig: ProcedureRig) -> None:
    hang(rig, np.array([0.0, 0.0, 490.0]))
    await require_no_deck(rig.bench.deck, rig.services)


async def test_before_anything_was_weighed_the_guide_alone_asks(rig: ProcedureRig) -> None:
    hang(rig, np.zeros(3))
    (rig.bench.calibrations.path / f"{PAYLOAD.name}.json").unlink()
    await require_no_deck(rig.bench.deck, rig.services)


async def test_a_light_deck_is_told_from_an_empty_gripper_by_what_the_remedy_says(
    rig: ProcedureRig,
) -> None:
    """Of 50 N less than the default of what a run lets the compensation be off."""
    hang(rig, np.array([0.0, 0.0, 50.0]))
    with pytest.raises(DeckInGripper, match="by more than max_untared_force_n, 80 N") as raised:
        await require_no_deck(rig.bench.deck, rig.services)
    assert "`max_untared_force_n` of its recipe" in raised.value.remedy
    assert "`cellctl calibrate invalidate payload --reason" in raised.value.remedy
    (recipe,) = rig.bench.deck.recipes
    mating = recipe.mating.model_copy(update={"max_untared_force_n": 40.0})
    lowered = recipe.model_copy(update={"mating": mating})
    await require_no_deck(replace(rig.bench.deck, recipes=(lowered,)), rig.services)
    rig.bench.calibrations.invalidate([PAYLOAD], "empty gripper")
    await require_no_deck(rig.bench.deck, rig.services)
