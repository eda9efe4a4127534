from collections.abc import Iterator
from itertools import repeat
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.solvers.hand_eye.hand_eye_result import Setup
from cellctl.errors.calibration import BoardNotFound, WrongBoard
from cellctl.processes.antenna_module.looking import Eyes
from cellctl.processes.antenna_module.procedures import board_drive
from cellctl.processes.antenna_module.procedures.board_drive import board_of
from cellctl.processes.antenna_module.roles import BOARD_SHOW, HOME
from cellctl.processes.antenna_module.stations import AntennaCell
from cellctl.runtime.procedure import ProcedureContext
from tests.rigs.procedure_record import Kept


def cell_with(board: str) -> AntennaCell:
    return cast(AntennaCell, SimpleNamespace(settings=SimpleNamespace(board=board, square_mm=1.5)))


def test_the_board_of_the_settings() -> None:
    assert str(board_of(cell_with("11x8"))) == "11 x 8 chessboard, 1.5 mm squares"


def test_a_board_that_hides_a_turn_is_refused_before_the_drive() -> None:
    """Intrinsics could do with it, but a hand-eye calibration would take turns for motions."""
    with pytest.raises(WrongBoard, match="180"):
        board_of(cell_with("10x8"))


class Arm:
    """Remembers where it was sent."""

    def __init__(self) -> None:
        self.targets: list[object] = []

    async def to(self, target: object) -> None:
        self.targets.append(target)

    to_taught = to


def drive(monkeypatch: pytest.MonkeyPatch, looks: Iterator[str | None]) -> tuple[Arm, Any]:
    """A cell whose camera sees a board or none, look after look."""
    arm = Arm()
    here = RigidTransform.identity()

    async def look(_eyes: object, name: str, *_: object) -> object:
        return SimpleNamespace(
            frames=(next(looks),),
            images=(np.zeros((4, 6)),),
            base_T_flange=here,
            joints_rad=name,
            look=name,
        )

    async def done(*_: object) -> None:
        pass

    monkeypatch.setattr(board_drive, "Mover", lambda _: arm)
    monkeypatch.setattr(board_drive, "leave_stations", done)
    monkeypatch.setattr(board_drive, "swung_poses", lambda *_: [here] * 5)
    monkeypatch.setattr(board_drive, "require_one_wrist", lambda _: None)
    monkeypatch.setattr(Eyes, "look", look)
    robot = SimpleNamespace(state=lambda: SimpleNamespace(base_T_flange=here))
    cell = SimpleNamespace(
        settings=SimpleNamespace(board="11x8", square_mm=1.5, flange_T_board_mm=10.0),
        arm=SimpleNamespace(robot=robot),
        camera_2=SimpleNamespace(name="camera_2"),
        workers=None,
    )
    return arm, board_drive.drive_round_board(
        cast(ProcedureContext, Kept()), cast(AntennaCell, cell), Setup.EYE_TO_HAND
    )


async def test_without_a_board_the_arm_goes_home_after_the_first_view(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    arm, driven = drive(monkeypatch, repeat(None))
    with pytest.raises(BoardNotFound, match=r"camera_2 sees no 11 x 8 chessboard.* taught pose"):
        await driven
    assert arm.targets[0] == BOARD_SHOW
    assert arm.targets[-1] == HOME
    assert len(arm.targets) == 4, "to the taught pose, to the first view, back and home"


async def test_a_later_view_without_the_board_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    _, driven = drive(monkeypatch, iter(["1", None, "3", None, "5"]))
    assert (await driven).views == ("1", "3", "5")
