"""All calibrations of the deck's cell, one Maintenance procedure after the other."""

import tomllib
from collections.abc import Callable
from pathlib import Path

from fakes.demo.control import Control
from fakes.demo.demo import Procedure


def _board_under(head: str, place: str) -> Callable[[Control, Path], None]:
    """The board where the head will measure, by the pose in the cell file: a person who lays it
    looks where that is."""

    def prepare(control: Control, cell: Path) -> None:
        keys = tomllib.loads(cell.read_text(encoding="utf-8"))
        carrier = keys["stereo_cameras"][head]["carried_by"]
        joints_deg = keys["robots"][carrier]["poses_deg"]["measuring"]
        control.request("present", frame=False, deck=False)
        control.request("remove_boards")
        control.request(place, head=head, joints_deg=joints_deg)

    return prepare


def _empty(control: Control, _cell: Path) -> None:
    control.request("present", frame=False, deck=False)
    control.request("remove_boards")


def _deck_only(control: Control, _cell: Path) -> None:
    control.request("remove_boards")
    control.request("present", frame=False, deck=True)


def _both(control: Control, _cell: Path) -> None:
    control.request("remove_boards")
    control.request("present", frame=True, deck=True)


PROCEDURES = (
    Procedure(101, "stereo head I", _board_under("head_1", "place_chessboard")),
    Procedure(102, "stereo head II", _board_under("head_2", "place_chessboard")),
    Procedure(103, "base frame in the large-field head", _empty),
    Procedure(104, "target board before head I", _board_under("head_1", "place_target_board")),
    Procedure(105, "target board before head II", _board_under("head_2", "place_target_board")),
    Procedure(106, "payload", _deck_only),
    Procedure(107, "stop latency", _deck_only),
    Procedure(108, "contact stiffness", _both),
)
