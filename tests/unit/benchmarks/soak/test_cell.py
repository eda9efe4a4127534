"""The cell that is soaked."""

from pathlib import Path
from typing import cast

from benchmarks.soak.cell import SoakedCell
from tests.rigs.whole_cell.own_cell import OwnCell, Program


def test_no_two_parts_of_a_cell_have_one_serial_number() -> None:
    cell = SoakedCell(OwnCell(Path()), cast(Program, None), cast(Program, None))
    assert [cell.new_serial() for _ in range(3)] == ["SAT-0001", "SAT-0002", "SAT-0003"]
