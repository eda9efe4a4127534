import asyncio
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from cellctl.cell.contact_motion.motions import Condition, ContactMotion, Ended
from cellctl.processes.peg_in_hole.faults import (
    FaceAbsent,
    FaceTilted,
    FaceUneven,
    PegSlipped,
)
from cellctl.processes.peg_in_hole.search.face import FacePlan, TouchedFace, touch_face
from tests.rigs.insertion.kinematic import KinematicMotions
from tests.rigs.insertion.surface import Truth
from tests.unit.processes.peg_in_hole.tasks import pin

FAR = np.array([100e-3, 100e-3])
"""The hole is nowhere near the touches."""
PANEL_M = 5e-3
"""Depth of a panel below the face of a plug."""


def touched(motions: KinematicMotions) -> TouchedFace:
    return asyncio.run(touch_face(motions, motions.task, FacePlan(8e-3, 3e-3)))


def plate(slope: tuple[float, float], seed: int = 0) -> KinematicMotions:
    truth = Truth(FAR, np.array(slope))
    return KinematicMotions(pin(), truth, np.random.default_rng(seed))


def test_slopes_are_found_as_well_as_they_are_said_to_be() -> None:
    slope = (0.02, -0.01)
    faces = [touched(plate(slope, seed)) for seed in range(200)]
    scatter = np.std([face.slope - slope for face in faces], axis=0)
    np.testing.assert_allclose(scatter, faces[0].slope_sigma, rtol=0.25)
    assert abs(np.mean([face.depth_m for face in faces])) < 5e-6
    assert faces[0].tilt_rad == pytest.approx(np.hypot(*slope), rel=0.2)
    assert faces[0].slope[0] > 0
    assert faces[0].yields_m == pytest.approx(8.0 / 1e6, rel=0.2)


def test_a_tilted_face_is_a_fault() -> None:
    with pytest.raises(FaceTilted, match=r"4\.\d°"):
        touched(plate((0.08, 0.0)))


@pytest.mark.parametrize("slope", [(-0.05, 0.0), (0.0, -0.05)])
def test_a_tilted_face_is_met_by_touches_alone(slope: tuple[float, float]) -> None:
    """It is as high as it may be, and rises towards the first place by 2.9 degrees."""
    motions, higher_m = Ways(), 3e-3
    motions.raised_m = higher_m
    motions.slope = np.array(slope)
    asyncio.run(touch_face(motions, motions.task, FacePlan(20e-3, higher_m, PANEL_M)))
    assert motions.met_early == 0


class NothingThere(KinematicMotions):
    async def touch(
        self,
        direction: NDArray[np.float64],
        travel_m: float,
        force_n: float,
        speed_m_s: float | None = None,
        until: Condition | None = None,
    ) -> ContactMotion:
        felt = await super().touch(direction, travel_m, force_n, speed_m_s, until)
        return ContactMotion(Ended.TRAVEL, felt.samples)


def test_no_face_is_a_fault() -> None:
    motions = NothingThere(pin(), Truth(FAR, np.zeros(2)), np.random.default_rng(0))
    with pytest.raises(FaceAbsent, match=r"no contact at x 8\.0, y 0\.0 mm"):
        touched(motions)


class Ways(KinematicMotions):
    """Touches a panel round a plug; keeps the way of the free motions, and may be stopped on one
    of them."""

    def __init__(self, stopped_at: int | None = None) -> None:
        super().__init__(pin(), Truth(FAR, np.zeros(2)), np.random.default_rng(0))
        self.places_m: list[NDArray[np.float64]] = []
        self.met_early = 0
        self.raised_m, self.slope = 0.0, np.zeros(2)
        self._stopped_at = stopped_at

    def _depth_m(self) -> float:
        return PANEL_M - self.raised_m + float(self.slope @ self.position_m[:2])

    async def move_free(
        self,
        task_position_tip_m: NDArray[np.float64],
        task_rotation_tip_rad: NDArray[np.float64],
        speed_m_s: float,
    ) -> ContactMotion:
        moved = await super().move_free(task_position_tip_m, task_rotation_tip_rad, speed_m_s)
        self.places_m.append(moved.last.task_position_tip_m[:2])
        self.met_early += float(moved.last.task_position_tip_m[2]) > self._depth_m()
        stopped = len(self.places_m) == self._stopped_at
        return ContactMotion(Ended.FORCE if stopped else moved.ended, moved.samples)


def test_the_way_round_a_plug_never_cuts_the_circle_of_the_touches() -> None:
    ways, radius_m = Ways(), 8e-3
    asyncio.run(touch_face(ways, ways.task, FacePlan(radius_m, 3e-3, PANEL_M)))
    assert len(ways.places_m) > 8
    for begin_m, end_m in pairwise(ways.places_m):
        between_m = np.linspace(begin_m, end_m, 50)
        assert np.hypot(*between_m.T).min() > radius_m - 1e-9
        assert np.hypot(*between_m.T).max() < 1.05 * radius_m


@pytest.mark.parametrize("stopped_at", [1, 2, 4])
def test_what_stands_in_the_way_to_the_face_is_a_fault(stopped_at: int) -> None:
    ways = Ways(stopped_at)
    with pytest.raises(FaceAbsent, match=r"something stands in the way to it at x -?\d"):
        asyncio.run(touch_face(ways, ways.task, FacePlan(8e-3, 3e-3, PANEL_M)))
    assert len(ways.places_m) == stopped_at


class GivesWay(KinematicMotions):
    """A touch that goes all of its way, with these axial forces at its last tenths of a way."""

    felt_n: tuple[float, ...] = ()

    async def touch(
        self,
        direction: NDArray[np.float64],
        travel_m: float,
        force_n: float,
        speed_m_s: float | None = None,
        until: Condition | None = None,
    ) -> ContactMotion:
        felt = await super().touch(direction, travel_m, force_n, speed_m_s, until)
        down_m = np.array([0.0, 0.0, 1e-4])
        samples = [
            replace(
                felt.last,
                task_position_tip_m=felt.last.task_position_tip_m + number * down_m,
                force_n=np.array([0.0, 0.0, -axial_n]),
            )
            for number, axial_n in enumerate(self.felt_n)
        ]
        return ContactMotion(Ended.TRAVEL, tuple(samples))


def test_a_part_that_is_pushed_into_the_fingers_has_slipped() -> None:
    """The force stays at that of the grip while the arm goes on: there is a face."""
    motions = GivesWay(pin(), Truth(FAR, np.zeros(2)), np.random.default_rng(0))
    motions.felt_n = (0.0, 0.1, 2.0, *[4.1, 3.9] * 6)
    with pytest.raises(PegSlipped, match=r"3\.\d N at x 8\.0, y 0\.0 mm, .* over 1\.2 mm"):
        touched(motions)


def test_an_arm_that_is_so_soft_may_have_met_the_face() -> None:
    """With 2 N/mm a face makes 8 N after 4 mm: nobody can tell it from fingers after one."""
    motions = GivesWay(pin(stiffness_n_m=2e3), Truth(FAR, np.zeros(2)), np.random.default_rng(0))
    motions.felt_n = (0.0, 0.1, *[2.1] * 12)
    with pytest.raises(FaceAbsent):
        touched(motions)


@pytest.mark.parametrize(
    "felt_n",
    [
        (0.4, -0.4) * 8,
        (0.0,) * 14 + (4.0, 4.0),
        (0.0, 4.0, 4.0, 4.0, 4.0, 4.0) + (0.0,) * 8,
    ],
    ids=["noise", "met at its end", "passed by"],
)
def test_a_face_that_was_not_met_is_no_slip(felt_n: tuple[float, ...]) -> None:
    motions = GivesWay(pin(), Truth(FAR, np.zeros(2)), np.random.default_rng(0))
    motions.felt_n = felt_n
    with pytest.raises(FaceAbsent):
        touched(motions)


class ChipUnderTheProof(KinematicMotions):
    async def touch(
        self,
        direction: NDArray[np.float64],
        travel_m: float,
        force_n: float,
        speed_m_s: float | None = None,
        until: Condition | None = None,
    ) -> ContactMotion:
        felt = await super().touch(direction, travel_m, force_n, speed_m_s, until)
        if self.touches == 2:
            felt.last.task_position_tip_m[2] -= 0.3e-3
        return felt


def test_a_chip_is_a_fault() -> None:
    motions = ChipUnderTheProof(pin(), Truth(FAR, np.zeros(2)), np.random.default_rng(0))
    with pytest.raises(FaceUneven, match=r"-0\.\d+ mm beside the plane"):
        touched(motions)
