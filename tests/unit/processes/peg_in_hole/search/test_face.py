import asyncio

import numpy as np
import pytest
from numpy.typing import NDArray

from cellctl.cell.contact_motion.motions import ContactMotion, Ended
from cellctl.errors.streamed_contact import StreamLate
from cellctl.processes.peg_in_hole.faults import FaceAbsent, FaceTilted, FaceUneven
from cellctl.processes.peg_in_hole.search.face import FacePlan, TouchedFace, touch_face
from tests.rigs.insertion.kinematic import KinematicMotions
from tests.rigs.insertion.surface import Truth
from tests.unit.processes.peg_in_hole.tasks import pin

FAR = np.array([100e-3, 100e-3])
"""The hole is nowhere near the touches."""


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


class NothingThere(KinematicMotions):
    ended = Ended.TRAVEL

    async def touch(
        self,
        direction: NDArray[np.float64],
        travel_m: float,
        force_n: float,
        speed_m_s: float | None = None,
    ) -> ContactMotion:
        felt = await super().touch(direction, travel_m, force_n, speed_m_s)
        return ContactMotion(self.ended, felt.samples)


def test_a_touch_that_late_ticks_have_kept_from_its_way_says_nothing_of_the_face() -> None:
    motions = NothingThere(pin(), Truth(FAR, np.zeros(2)), np.random.default_rng(0))
    motions.ended = Ended.TIME
    with pytest.raises(StreamLate, match=r"x 8\.0, y 0\.0 mm did not go its"):
        touched(motions)


def test_no_face_is_a_fault() -> None:
    motions = NothingThere(pin(), Truth(FAR, np.zeros(2)), np.random.default_rng(0))
    with pytest.raises(FaceAbsent, match=r"no contact at x 8\.0, y 0\.0 mm"):
        touched(motions)


class ChipUnderTheProof(KinematicMotions):
    async def touch(
        self,
        direction: NDArray[np.float64],
        travel_m: float,
        force_n: float,
        speed_m_s: float | None = None,
    ) -> ContactMotion:
        felt = await super().touch(direction, travel_m, force_n, speed_m_s)
        if self.touches == 2:
            felt.last.task_position_tip_m[2] -= 0.3e-3
        return felt


def test_a_chip_is_a_fault() -> None:
    motions = ChipUnderTheProof(pin(), Truth(FAR, np.zeros(2)), np.random.default_rng(0))
    with pytest.raises(FaceUneven, match=r"-0\.\d+ mm beside the plane"):
        touched(motions)
