"""The watch over the arms says how long and how far they went on."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from fakes.motion_watch import MotionWatch
from fakes.scenes.load import load
from fakes.world.robot import RobotArm
from fakes.world.truth import draw

SCENARIO = load(Path(__file__).parents[3] / "config" / "deck.scenario.toml")
ROBOT = SCENARIO.robots["main"]
SPEED_M_S = 0.02


@pytest.fixture
def arm() -> RobotArm:
    return RobotArm(ROBOT, draw(SCENARIO, 1).robots["main"], 1)


def sampled(watch: MotionWatch, from_s: float, to_s: float) -> float:
    for time_s in np.arange(from_s, to_s, 0.01):
        watch.sample(float(time_s))
    return to_s


def at_work(arm: RobotArm) -> float:
    arm.start_joint(0.0, np.deg2rad([0, -52.766, 109.14, 0, 33.626, 90]), 100)
    return arm.standstill_s + 0.1


def down(arm: RobotArm, time_s: float, way_m: float) -> None:
    target = RigidTransform.from_translation([0, 0, -way_m]) * arm.encoder_pose(time_s)
    arm.start_linear(time_s, target, SPEED_M_S, 0.2)


def test_a_stop_in_a_motion_that_was_under_way(arm: RobotArm) -> None:
    watch = MotionWatch({"main": arm})
    time_s = at_work(arm)
    down(arm, time_s, 0.1)
    time_s += 1.0
    watch.begin(time_s)
    arm.stop(time_s)
    sampled(watch, time_s, time_s + 2.0)
    report = watch.report(time_s + 2.0)
    (motion,) = report["motions"]["main"]
    braking = ROBOT.stop_deceleration_mm_s2 / 1000
    latency_s = ROBOT.stop_latency_ms / 1000
    over_mm = 1000 * (SPEED_M_S * latency_s + SPEED_M_S**2 / (2 * braking))
    assert motion["begun_s"] == 0.0
    assert motion["ended_s"] == pytest.approx(latency_s + SPEED_M_S / braking, abs=1e-6)
    assert motion["travel_mm"] == pytest.approx(over_mm, abs=0.05)
    assert motion["rise_mm"] == pytest.approx(-over_mm, abs=0.05)
    assert motion["turn_deg"] < 0.01
    assert report["watched_s"] == pytest.approx(2.0)


def test_a_motion_that_begins_later_is_another_one(arm: RobotArm) -> None:
    watch = MotionWatch({"main": arm})
    time_s = at_work(arm)
    watch.begin(time_s)
    for _ in range(2):
        down(arm, time_s, 0.01)
        time_s = sampled(watch, time_s, time_s + 3.0)
    first, second = watch.report(time_s)["motions"]["main"]
    assert first["ended_s"] < 1.0 < second["begun_s"]
    assert second["travel_mm"] == pytest.approx(10.0, abs=0.05)


def test_an_arm_that_stands_has_no_motion(arm: RobotArm) -> None:
    watch = MotionWatch({"main": arm})
    assert watch.report(1.0)["motions"] == {}
    watch.begin(1.0)
    sampled(watch, 1.0, 2.0)
    assert watch.report(2.0)["motions"] == {"main": []}


def test_a_motion_that_goes_on_has_no_end(arm: RobotArm) -> None:
    watch = MotionWatch({"main": arm})
    time_s = at_work(arm)
    watch.begin(time_s)
    down(arm, time_s, 0.1)
    sampled(watch, time_s, time_s + 1.0)
    (motion,) = watch.report(time_s + 1.0)["motions"]["main"]
    assert motion["ended_s"] is None
    watch.begin(time_s + 1.0)
    (motion,) = watch.report(time_s + 1.0)["motions"]["main"]
    assert motion["begun_s"] == 0.0
