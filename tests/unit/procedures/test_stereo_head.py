"""Procedures 101 and 102: the head swings about the board and comes back."""

from types import SimpleNamespace

import numpy as np
import pytest

from cellctl.errors.calibration import BoardNotFound
from cellctl.errors.link import ReplyTimeout
from cellctl.errors.vision import ImageBlack
from cellctl.geometry.pose import MM
from tests.unit.procedures.rig import ProcedureRig


class Solver:
    """Stands in for detection and adjustment."""

    def __init__(self, rig: ProcedureRig, seen: bool = True) -> None:
        self.views: list[str] = []
        self.given: tuple[object, ...] = ()
        self._seen = seen
        rig.answer(
            detect_view=self.detect, calibrate_stereo=self._solve, stereo_picture=lambda _: b"png"
        )

    def detect(self, pair: object, board: object) -> object | None:
        self.views.append(pair.name)  # type: ignore[attr-defined]
        every_other = len(self.views) % 2
        return pair if self._seen and every_other else None

    def _solve(self, views: object, board: object, image_size: object) -> object:
        self.given = views, board, image_size
        return SimpleNamespace(
            to_record=lambda: {"verdict": "pass"}, passed=True, warnings=("few corners",)
        )


async def test_all_views_are_taken_and_the_head_comes_back(rig: ProcedureRig) -> None:
    solver, station = Solver(rig), rig.bench.cell.head_1
    outcome = await rig.run(101)
    count = rig.bench.settings.stereo_views
    robot = rig.bench.cell.aux_1
    taught, *views, back = robot.moves
    np.testing.assert_allclose(taught.target, np.radians(station.config.poses_deg["measuring"]))
    assert len(views) == count == len(solver.views)
    assert all(move.kind == "linear" for move in views)
    assert views[0].speed == pytest.approx(station.config.linear_speed_mm_s * MM)
    np.testing.assert_allclose(views[0].target.as_matrix(), back.target.as_matrix(), atol=1e-9)
    assert (outcome.kind.name, outcome.serial_number, outcome.picture_png) == (
        "head_1", "FH-0001", b"png",
    )  # fmt: skip
    used, board, image_size = solver.given
    assert len(used) == count / 2  # type: ignore[arg-type]
    assert str(board).startswith("9 x 6 chessboard, 25 mm")
    assert image_size == (6, 4)
    told = [progress.iteration for progress in rig.told if "view" in progress.message]
    assert told == list(range(1, count + 1))


async def test_without_a_board_the_head_does_not_begin_to_swing(rig: ProcedureRig) -> None:
    solver = Solver(rig, seen=False)
    with pytest.raises(BoardNotFound, match=r"head_2 sees no 9 x 6 chessboard.* its taught pose"):
        await rig.run(102)
    assert len(solver.views) == 1
    _taught, first = rig.bench.cell.aux_2.moves
    np.testing.assert_allclose(
        first.target.as_matrix(), rig.bench.cell.aux_2.state().base_T_flange.as_matrix(), atol=1e-9
    )


async def test_a_camera_that_falls_silent_ends_it(rig: ProcedureRig) -> None:
    Solver(rig)
    rig.bench.cell.head_1.camera.silent = True  # type: ignore[attr-defined]
    with pytest.raises(ReplyTimeout):
        await rig.run(101)
    assert len(rig.bench.cell.aux_1.moves) == 2


async def test_a_fault_in_the_middle_leaves_the_head_there_and_says_where(
    rig: ProcedureRig,
) -> None:
    solver, station = Solver(rig), rig.bench.cell.head_1

    def silent_from_the_third_on(pair: object, board: object) -> object | None:
        station.camera.silent = len(solver.views) == 1  # type: ignore[attr-defined]
        return solver.detect(pair, board)

    rig.answer(detect_view=silent_from_the_third_on)
    with pytest.raises(ReplyTimeout) as caught:
        await rig.run(101)
    assert len(rig.bench.cell.aux_1.moves) == 1 + 3, "to the board, and to three views"
    (note,) = caught.value.__notes__
    assert note.startswith("head_1 was left at or near view 3 of 24, tilted over the board")


async def test_a_view_that_cannot_be_measured_names_its_head(rig: ProcedureRig) -> None:
    Solver(rig)

    def black(*_: object) -> None:
        raise ImageBlack("view 1 left: 99.9 % of the pixels are below level 12")

    rig.answer(detect_view=black)
    with pytest.raises(ImageBlack, match="head_1, view 1 left"):
        await rig.run(101)
