"""Accelerations of straight moves: the jobs know whole percents, and do no more than asked."""

import math

import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.errors.robot import TargetOutOfBounds
from cellctl.geometry.pose import MM
from tests.rigs.wire.job_rig import job_rig

ASKED_AND_DONE_MM_S2 = (
    (10.0, 10.0), (19.0, 10.0), (20.0, 20.0), (49.9, 20.0), (50.0, 50.0), (99.0, 50.0),
    (100.0, 100.0), (200.0, 200.0), (499.0, 200.0), (500.0, 500.0), (1000.0, 1000.0),
)  # fmt: skip


async def test_the_arm_accelerates_no_more_than_it_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    done_mm_s2 = []
    async with job_rig() as rig:
        await rig.connect()
        start_linear = rig.arm.start_linear

        def begun(time_s: float, pose: RigidTransform, speed: float, acceleration: float) -> None:
            done_mm_s2.append(round(acceleration / MM, 6))
            start_linear(time_s, pose, speed, acceleration)

        monkeypatch.setattr(rig.arm, "start_linear", begun)
        here = rig.robot.state().base_T_flange
        for index, (asked_mm_s2, _) in enumerate(ASKED_AND_DONE_MM_S2):
            target = RigidTransform.from_translation([0.0, 0.0, 1e-5 * (index % 2)]) * here
            await rig.robot.move_linear(target, speed_m_s=0.05, acceleration_m_s2=asked_mm_s2 * MM)
    assert done_mm_s2 == [done for _, done in ASKED_AND_DONE_MM_S2]


async def test_less_than_the_jobs_know_is_refused() -> None:
    async with job_rig() as rig:
        await rig.connect()
        least_m_s2 = rig.robot.least_acceleration_m_s2()
        assert math.isclose(least_m_s2, 0.01)
        here = rig.robot.state().base_T_flange
        with pytest.raises(TargetOutOfBounds, match="none below 10"):
            await rig.robot.move_linear(here, speed_m_s=0.05, acceleration_m_s2=0.99 * least_m_s2)
