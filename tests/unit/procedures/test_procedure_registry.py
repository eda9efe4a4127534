"""What the numbers of Maintenance mean."""

import pytest
from cellctl.runtime.procedure_registry import ProcedureOrder, procedure_order
from cellctl.runtime.step import Step

from cellctl.config import CellConfig, load_cell
from tests.unit.cell.bench import CELL_FILE


@pytest.fixture(scope="module")
def config() -> CellConfig:
    """Of a cell with two recipes."""
    shipped = load_cell(CELL_FILE)
    second = shipped.recipes[0].model_copy(update={"id": 7})
    return shipped.model_copy(update={"recipes": (shipped.recipes[0], second)})


@pytest.mark.parametrize("number", [101, 103, 105, 107, 108])
def test_a_plain_number_is_a_procedure_with_the_first_recipe(
    config: CellConfig, number: int
) -> None:
    assert procedure_order(number, config) == ProcedureOrder(Step(number), config.recipes[0])


def test_contact_stiffness_can_be_had_of_every_recipe(config: CellConfig) -> None:
    for number, recipe in ((10_801, config.recipes[0]), (10_807, config.recipes[1])):
        order = ProcedureOrder(Step.MEASURE_CONTACT_STIFFNESS, recipe)
        assert procedure_order(number, config) == order


@pytest.mark.parametrize("number", [0, 1, 10, 60, 100, 109, 10_800, 10_802, 65_535])
def test_other_numbers_are_none(config: CellConfig, number: int) -> None:
    assert procedure_order(number, config) is None
