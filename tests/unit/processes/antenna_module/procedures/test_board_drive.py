from types import SimpleNamespace
from typing import cast

import pytest

from cellctl.errors.calibration import WrongBoard
from cellctl.processes.antenna_module.procedures.board_drive import board_of
from cellctl.processes.antenna_module.stations import AntennaCell


def cell_with(board: str) -> AntennaCell:
    return cast(AntennaCell, SimpleNamespace(settings=SimpleNamespace(board=board, square_mm=1.5)))


def test_the_board_of_the_settings() -> None:
    assert str(board_of(cell_with("11x8"))) == "11 x 8 chessboard, 1.5 mm squares"


def test_a_board_that_hides_a_turn_is_refused_before_the_drive() -> None:
    """Intrinsics could do with it, but a hand-eye calibration would take turns for motions."""
    with pytest.raises(WrongBoard, match="180"):
        board_of(cell_with("10x8"))
