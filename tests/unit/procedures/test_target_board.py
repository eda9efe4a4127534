"""Procedures 104 and 105: one board, seen twice before each head; both are needed, once."""

import asyncio
from collections.abc import Sequence
from datetime import timedelta
from typing import Any

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
from cellctl.procedures.target_board import PAIRS
from cellctl.processes.deck_to_frame.calibrations import (
    BASE_FRAME,
    BOARD_TRANSFER,
    PAYLOAD,
    STEREO_HEAD_1,
)
from cellctl.runtime.procedure import ProcedureOutcome
from cellctl.vision.camera.ellipse import Ellipse
from cellctl.vision.features.hole import Hole
from cellctl.vision.measurement import HoleMeasurement, PairMeasurement
from tests.unit.procedures.large_field import FIELD_SIGMA_M, Field
from tests.unit.procedures.rig import ProcedureRig

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
        rig.answer(measure_pair=self._measure, transfer_picture=lambda _: b"png")
        self.field = Field.of(rig)

    def place(self, head: str) -> None:
        c_T_board = self.c_T_base * BASE_T_C[head] * self.head_T_board
        truth = {
            name: c_T_board.apply(place) + self.rng.normal(0, FIELD_SIGMA_M, 3)
            for name, place in target_board_discs().items()
        }
        self.field.see(truth | {"F1": np.zeros(3)})

    def _measure(
        self, left: Any, right: Any, model: object, discs: Sequence[Hole], *,
        camera_T_part: RigidTransform, search_radius_m: float,
    ) -> PairMeasurement:  # fmt: skip
        assert search_radius_m < 0.04, "less than half the pitch of the discs"
        self.predicted.append(camera_T_part)
        return PairMeasurement("default", tuple(self._disc(disc) for disc in discs))

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


async def test_a_board_that_lies_elsewhere_is_looked_for_once(
    rig: ProcedureRig, boards: Boards
) -> None:
    """With the first picture of a head, in the whole of it; the others look where it was found."""
    elsewhere = pose_from_xyzabc([5, -8, 505, 3, 21, 179])
    searched: list[RigidTransform] = []

    def search(_images: object, _discs: object, told: RigidTransform) -> RigidTransform:
        searched.append(told)
        return elsewhere

    def near(*seen: Any, camera_T_part: RigidTransform, search_radius_m: float) -> PairMeasurement:
        if camera_T_part is not elsewhere:
            raise HoleMissing("nothing like P7 was seen by both cameras")
        return boards._measure(*seen, camera_T_part=camera_T_part, search_radius_m=search_radius_m)

    rig.answer(measure_pair=near, pose_turned_like=search, transfer_picture=lambda _: b"png")
    for head, number in (("head_1", 104), ("head_2", 105)):
        boards.place(head)
        outcome = await half(rig, number)
    assert outcome is not None
    assert outcome.passed
    assert len(searched) == 2
    assert boards.predicted == [elsewhere] * 2 * PAIRS


async def test_a_board_that_is_covered_later_ends_the_procedure(
    rig: ProcedureRig, boards: Boards
) -> None:
    """Someone reaches over the board: what was found before must not be looked for elsewhere."""

    def covered(*seen: Any, **expected: Any) -> PairMeasurement:
        if boards.predicted:
            raise HoleMissing("nothing like P7 was seen by both cameras")
        return boards._measure(*seen, **expected)

    rig.answer(measure_pair=covered, pose_turned_like=pytest.fail)
    boards.place("head_1")
    with pytest.raises(HoleMissing):
        await half(rig, 104)


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
