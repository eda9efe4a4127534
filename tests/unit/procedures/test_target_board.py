"""Procedures 104 and 105: one board, seen twice before each head; both are needed, once."""

import asyncio
from datetime import timedelta

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.boards.board_pose import target_board_discs
from cellctl.calibration.solvers.transfer.board_transfer import TransferResult
from cellctl.calibration.store.envelope import read_calibration
from cellctl.errors.calibration import CalibrationMissing
from cellctl.errors.link import ReplyTimeout
from cellctl.errors.vision import HoleMissing
from cellctl.geometry.pose import pose_error, pose_from_xyzabc
from cellctl.procedures.target_board import PAIRS, board_discs, measured_board
from cellctl.processes.deck_to_frame.calibrations import (
    BASE_FRAME,
    BOARD_TRANSFER,
    PAYLOAD,
    STEREO_HEAD_1,
)
from cellctl.runtime.procedure import ProcedureOutcome
from cellctl.vision.camera.ellipse import Ellipse
from cellctl.vision.features.hole import Hole
from cellctl.vision.holes.search import HeadImages
from cellctl.vision.measurement import HoleMeasurement, PairMeasurement
from tests.rigs.calibration.drawn_discs import drawn_discs
from tests.unit.procedures.large_field import FIELD_SIGMA_M, Field
from tests.unit.procedures.rig import ProcedureRig
from tests.unit.vision.plates import plate_facing, table_1_head

HEAD_SIGMA_M = 5e-6
BASE_T_C = {
    "head_1": pose_from_xyzabc([1700, -400, 950, 90, 5, 178]),
    "head_2": pose_from_xyzabc([2100, 400, 950, -90, 5, 178]),
}


class Boards:
    """A board before one head, where both that head and the large-field head see it."""

    def __init__(self, rig: ProcedureRig) -> None:
        self.rng = np.random.default_rng(0)
        self.rig = rig
        self.c_T_base = rig.bench.calibrations.read(BASE_FRAME).c_T_base.pose
        self.head_T_board = pose_from_xyzabc([5, -8, 505, 3, 1, 179])
        self.predicted: list[RigidTransform] = []
        self.may_lie_elsewhere: list[bool] = []
        rig.answer(measured_board=self._measure, transfer_picture=lambda _: b"png")
        self.field = Field.of(rig)

    def place(self, head: str) -> None:
        c_T_board = self.c_T_base * BASE_T_C[head] * self.head_T_board
        truth = {
            name: c_T_board.apply(place) + self.rng.normal(0, FIELD_SIGMA_M, 3)
            for name, place in target_board_discs().items()
        }
        self.field.see(truth | {"F1": np.zeros(3)})

    def _measure(
        self, _images: HeadImages, head_T_board: RigidTransform, *, may_lie_elsewhere: bool
    ) -> tuple[PairMeasurement, RigidTransform]:
        self.predicted.append(head_T_board)
        self.may_lie_elsewhere.append(may_lie_elsewhere)
        discs = tuple(self._disc(disc) for disc in board_discs())
        return PairMeasurement("default", discs), self.head_T_board

    def _disc(self, disc: Hole) -> HoleMeasurement:
        place = self.head_T_board.apply(disc.position_m) + self.rng.normal(0, HEAD_SIGMA_M, 3)
        ellipse = Ellipse(np.zeros(2), (30.0, 29.0), 0.0)
        pixel, spread = np.zeros(2), np.eye(2)
        return HoleMeasurement(
            disc.name, disc.kind, pixel, pixel, spread, spread, place,
            np.eye(3) * HEAD_SIGMA_M**2, ellipse, ellipse, disc.diameter_m, 0.1,
        )  # fmt: skip


async def half(rig: ProcedureRig, number: int) -> ProcedureOutcome | None:
    """104 or 105."""
    return await rig.procedures[number].run(rig.context)


@pytest.fixture
def boards(rig: ProcedureRig) -> Boards:
    return Boards(rig)


async def test_both_heads_are_found_in_the_base(rig: ProcedureRig, boards: Boards) -> None:
    cell = rig.bench.cell
    boards.place("head_1")
    assert await half(rig, 104) is None
    boards.place("head_2")
    outcome = await half(rig, 105)
    assert outcome is not None
    assert (outcome.kind, outcome.passed, outcome.picture_png) == (BOARD_TRANSFER, True, b"png")
    result = TransferResult.from_record(outcome.record)
    for head, found in (("head_1", result.base_T_c1), ("head_2", result.base_T_c2)):
        distance, angle = pose_error(BASE_T_C[head], found.pose)
        assert np.linalg.norm(distance) < 2e-4
        assert np.degrees(np.linalg.norm(angle)) < 0.03
    assert len(boards.predicted) == 2 * PAIRS
    for station in cell.heads:
        measured_at = station.config.poses_deg["measuring"]
        assert outcome.record["head_joints_deg"][station.name] == measured_at
    for station, robot, turn in zip(cell.heads, (cell.aux_1, cell.aux_2), (0, 1), strict=True):
        place = np.radians(station.config.poses_deg["measuring"])
        np.testing.assert_allclose(robot.moves[turn].target, place)


async def test_only_the_first_picture_of_a_head_is_looked_through_for_a_board_elsewhere(
    rig: ProcedureRig, boards: Boards
) -> None:
    """The others look where it was found: what covers the board then ends the procedure."""
    for head, number in (("head_1", 104), ("head_2", 105)):
        boards.place(head)
        outcome = await half(rig, number)
    assert outcome is not None
    assert outcome.passed
    assert boards.may_lie_elsewhere == 2 * [True, *[False] * (PAIRS - 1)]
    for first in (0, PAIRS):
        assert boards.predicted[first] is not boards.head_T_board
        later = boards.predicted[first + 1 : first + PAIRS]
        assert all(one is boards.head_T_board for one in later)


DISCS = board_discs()
LIES = plate_facing(4.0, -6.0, 3.0)
HEAD = table_1_head()
SEEN = HeadImages(HEAD, *drawn_discs(HEAD, LIES, DISCS))
"""The board tilted by 3° about two axes."""


def test_a_board_that_lies_elsewhere_is_measured_where_it_is_found() -> None:
    expected = plate_facing(50.0, 0.0)
    measured, found = measured_board(SEEN, expected, may_lie_elsewhere=True)
    distance_m, turn_rad = pose_error(LIES, found)
    assert np.linalg.norm(distance_m) < 1e-3
    assert np.degrees(np.linalg.norm(turn_rad)) < 1.0
    assert len(measured.holes) == len(DISCS)
    again, same = measured_board(SEEN, found, may_lie_elsewhere=False)
    assert same is found
    assert [hole.name for hole in again.holes] == [hole.name for hole in measured.holes]


def test_a_board_that_is_covered_later_is_not_looked_for_elsewhere() -> None:
    """What was found before must not be taken from another place of the images."""
    with pytest.raises(HoleMissing):
        measured_board(SEEN, plate_facing(50.0, 0.0), may_lie_elsewhere=False)


async def test_a_placement_serves_once(rig: ProcedureRig, boards: Boards) -> None:
    for head, number in (("head_1", 104), ("head_2", 105)):
        boards.place(head)
        await half(rig, number)
    assert rig.process._waiting.by_head == {}
    assert await half(rig, 105) is None


async def test_the_same_head_twice_does_not_make_a_pair(rig: ProcedureRig, boards: Boards) -> None:
    boards.place("head_1")
    for _ in range(2):
        assert await half(rig, 104) is None


async def test_the_head_must_be_calibrated_first(rig: ProcedureRig, boards: Boards) -> None:
    (rig.bench.calibrations.path / "head_1.json").unlink()
    boards.place("head_1")
    with pytest.raises(CalibrationMissing, match="head_1"):
        await half(rig, 104)


async def test_a_silent_large_field_head_ends_both(rig: ProcedureRig, boards: Boards) -> None:
    boards.place("head_1")
    rig.bench.cell.tracker.silent = True
    with pytest.raises(ReplyTimeout):
        await half(rig, 104)
    assert len(asyncio.all_tasks()) == 1, "nobody goes on grabbing"
    assert rig.process._waiting.by_head == {}


@pytest.mark.parametrize("spoil", ["head_1 is calibrated anew", "a fault invalidates something"])
async def test_what_a_head_saw_before_counts_no_longer(
    rig: ProcedureRig, boards: Boards, spoil: str
) -> None:
    boards.place("head_1")
    assert await half(rig, 104) is None
    store = rig.bench.calibrations
    if spoil.startswith("head_1"):
        stored = read_calibration(store.path, "head_1")
        store.store(STEREO_HEAD_1, stored.record, stored.serial_number, timedelta(days=1))
    else:
        store.invalidate([PAYLOAD], "collision")
    boards.place("head_2")
    assert await half(rig, 105) is None, "head I has to see the board again"
