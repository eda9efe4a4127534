"""All calibrations of the deck's cell, one Maintenance procedure after the other."""

from collections.abc import Callable

from fakes.demo.control import Control
from fakes.demo.demo import Procedure


def _chessboard(head: str) -> Callable[[Control], None]:
    def prepare(control: Control) -> None:
        control.request("present", frame=False, deck=False)
        control.request("remove_boards")
        control.request("place_chessboard", head=head)

    return prepare


def _target_board(head: str) -> Callable[[Control], None]:
    def prepare(control: Control) -> None:
        control.request("present", frame=False, deck=False)
        control.request("remove_boards")
        control.request("place_target_board", head=head)

    return prepare


def _empty(control: Control) -> None:
    control.request("present", frame=False, deck=False)
    control.request("remove_boards")


def _deck_only(control: Control) -> None:
    control.request("remove_boards")
    control.request("present", frame=False, deck=True)


def _both(control: Control) -> None:
    control.request("remove_boards")
    control.request("present", frame=True, deck=True)


PROCEDURES = (
    Procedure(101, "stereo head I", _chessboard("head_1")),
    Procedure(102, "stereo head II", _chessboard("head_2")),
    Procedure(103, "base frame in the large-field head", _empty),
    Procedure(104, "target board before head I", _target_board("head_1")),
    Procedure(105, "target board before head II", _target_board("head_2")),
    Procedure(106, "payload", _deck_only),
    Procedure(107, "stop latency", _deck_only),
    Procedure(108, "contact stiffness", _both),
)
