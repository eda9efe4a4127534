"""What the numbers of Maintenance mean."""

import pytest

from cellctl.errors.internal import Unexpected
from cellctl.processes.deck_to_frame.process import DeckToFrame
from cellctl.runtime.jobs.factory import procedures_by_number
from tests.unit.procedures.rig import ProcedureRig


def test_contact_stiffness_can_be_had_of_every_recipe(rig: ProcedureRig) -> None:
    shipped = rig.bench.recipe
    second = shipped.model_copy(update={"id": 7})
    cell = rig.bench.cell
    cell.config = cell.config.model_copy(update={"recipes": (shipped, second)})
    procedures = procedures_by_number({"deck-to-frame": DeckToFrame(rig.services)})
    assert set(procedures) == {*range(101, 110), 10_801, 10_807}
    assert {procedures[number].step for number in (108, 10_801, 10_807)} == {108}


def test_two_processes_may_not_share_a_number(rig: ProcedureRig) -> None:
    with pytest.raises(Unexpected, match="procedure 101"):
        procedures_by_number({"one": rig.process, "two": rig.process})


def test_a_cell_without_recipes_offers_no_procedures(rig: ProcedureRig) -> None:
    cell = rig.bench.cell
    cell.config = cell.config.model_copy(update={"recipes": ()})
    assert procedures_by_number({"deck-to-frame": DeckToFrame(rig.services)}) == {}
