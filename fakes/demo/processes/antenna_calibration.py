"""All calibrations of the antenna's cell, one Maintenance procedure after the other."""

from pathlib import Path

from fakes.demo.control import Control
from fakes.demo.demo import Procedure


def _board_on_table(control: Control, cell: Path) -> None:
    _put_away(control, cell)
    control.request("place_board", where="table")


def _board_on_flange(control: Control, cell: Path) -> None:
    _put_away(control, cell)
    control.request("place_board", where="flange")


def _put_away(control: Control, _cell: Path) -> None:
    control.request("remove_boards")


def _stand_by(control: Control, cell: Path) -> None:
    """A module and a socket to plug by hand, and after each the next ones."""
    _put_away(control, cell)
    control.request("load")
    control.request("stand_by", on=True)


PROCEDURES = (
    Procedure(201, "lens of camera I", _board_on_table),
    Procedure(202, "lens of camera II", _board_on_flange),
    Procedure(203, "camera I on the flange", _board_on_table),
    Procedure(204, "camera II in the base frame", _board_on_flange),
    Procedure(205, "reference: axis, marks and plate", _put_away),
    Procedure(207, "tool, by turning over camera II", _put_away),
    Procedure(206, "plug correction, taught", _stand_by, timeout_s=1200.0),
)
