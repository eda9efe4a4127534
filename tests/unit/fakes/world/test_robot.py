import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.world.arm import forward, nominal_links
from fakes.world.frames import distance, from_written, matrix_distance, written_matrix
from fakes.world.robot import RefusedMotionError, RobotArm
from fakes.world.truth import draw


def arm_of(scenario: DeckScenario, seed: int = 1) -> RobotArm:
    return RobotArm(scenario.robots["main"], draw(scenario, seed).robots["main"], seed)


def at_work(scenario: DeckScenario, seed: int = 1) -> tuple[RobotArm, float]:
    arm = arm_of(scenario, seed)
    arm.start_joint(0.0, np.deg2rad([0, -52.766, 109.14, 0, 33.626, 90]), 100)
    return arm, arm.standstill_s


def shifted(arm: RobotArm, time_s: float, z_m: float) -> RigidTransform:
    return RigidTransform.from_translation([0, 0, z_m]) * arm.encoder_pose(time_s)


def test_stop_over_travels_by_latency_and_ramp(scenario: DeckScenario) -> None:
    arm, t = at_work(scenario)
    speed, settings = 0.01, scenario.robots["main"]
    arm.start_linear(t, shifted(arm, t, -0.05), speed, 0.2)
    ask_s = t + 2.0
    before = arm.encoder_pose(ask_s).translation[2]
    arm.stop(ask_s)
    latency_s = settings.stop_latency_ms / 1000
    braking = settings.stop_deceleration_mm_s2 / 1000
    over = before - arm.encoder_pose(arm.standstill_s).translation[2]
    assert arm.standstill_s == pytest.approx(ask_s + latency_s + speed / braking)
    assert over == pytest.approx(speed * latency_s + speed**2 / (2 * braking), abs=1e-7)
    assert arm.cut_short


def test_motion_that_ends_within_the_latency_reaches_its_target(scenario: DeckScenario) -> None:
    arm, t = at_work(scenario)
    target = shifted(arm, t, -0.001)
    arm.start_linear(t, target, 0.05, 0.2)
    arm.stop(t + 0.05)
    assert not arm.cut_short
    np.testing.assert_allclose(
        arm.encoder_pose(arm.standstill_s).translation, target.translation, atol=1e-9
    )


def test_repeatability_over_long_ways(scenario: DeckScenario) -> None:
    """The stated ±0.05 mm is three standard deviations of what a long way leaves behind."""
    arm, t = at_work(scenario)
    here = arm.joints(t)
    errors = []
    for _ in range(120):
        for joints in (here + 0.3, here):
            arm.start_joint(t, joints, 100)
            t = arm.standstill_s
        true = arm.truth.cell_T_base * forward(arm.truth.links, here)
        errors.append(arm.flange(t).translation - true.translation)
    sigma_mm = np.std(errors, axis=0) * 1e3
    np.testing.assert_allclose(sigma_mm, 0.05 / 3, rtol=0.4)


def test_small_step_has_a_small_error(scenario: DeckScenario) -> None:
    arm, t = at_work(scenario)
    errors = []
    for index in range(100):
        before = arm.flange(t)
        arm.start_linear(t, shifted(arm, t, 1e-4 if index % 2 else -1e-4), 0.01, 0.2)
        t = arm.standstill_s
        done = arm.flange(t).translation - before.translation
        errors.append(done - [0, 0, 1e-4 if index % 2 else -1e-4])
    assert 1e-6 < np.std(errors) < 4e-6


def test_target_beyond_reach_is_refused(scenario: DeckScenario) -> None:
    arm, t = at_work(scenario)
    with pytest.raises(RefusedMotionError, match="REACH"):
        arm.start_linear(t, from_written([3900, 0, 967, 90, 0, 180]), 0.05, 0.2)
    assert not arm.moving(t)


@pytest.mark.parametrize(
    ("joints_deg", "reason"),
    [([0, -52.8, 109.1, 0, 0.1, 90], "SINGULAR"), ([0, -52.8, 109.1, 0, 121, 90], "LIMIT")],
)
def test_target_that_the_joints_cannot_take_is_refused(
    scenario: DeckScenario, joints_deg: list[float], reason: str
) -> None:
    arm, t = at_work(scenario)
    chain = nominal_links(scenario.robots["main"].chain_mm)
    target = forward(chain, np.deg2rad(joints_deg))
    with pytest.raises(RefusedMotionError, match=reason):
        arm.start_linear(t, target, 0.05, 0.2)


def test_joint_limits_and_percent_are_checked(scenario: DeckScenario) -> None:
    arm = arm_of(scenario)
    with pytest.raises(RefusedMotionError, match="LIMIT"):
        arm.start_joint(0.0, np.deg2rad([0, 30, 0, 0, 0, 0]), 10)
    with pytest.raises(RefusedMotionError, match="SPEED"):
        arm.start_joint(0.0, np.zeros(6), 0)


def test_step_limits(scenario: DeckScenario) -> None:
    arm, t = at_work(scenario)
    arm.check_step(t, shifted(arm, t, 0.5e-3))
    with pytest.raises(RefusedMotionError, match="STEP"):
        arm.check_step(t, shifted(arm, t, 0.51e-3))


def test_override_slows_down(scenario: DeckScenario) -> None:
    arm, t = at_work(scenario)
    arm.override_percent = 50
    arm.start_linear(t, shifted(arm, t, -0.05), 0.05, 10.0)
    assert arm.standstill_s - t == pytest.approx(2.0, abs=0.05)


def test_true_pose_does_not_jump_when_a_motion_begins(scenario: DeckScenario) -> None:
    arm, t = at_work(scenario)
    before = arm.flange(t).translation
    arm.start_linear(t, shifted(arm, t, -0.05), 0.05, 0.2)
    np.testing.assert_allclose(arm.flange(t).translation, before, atol=1e-9)


def test_a_followed_setpoint_is_reached_within_its_period(scenario: DeckScenario) -> None:
    arm, t = at_work(scenario)
    for number in range(1, 51):
        target = shifted(arm, t, -5e-5)
        arm.follow(t, target.as_matrix(), 0.008)
        assert arm.moving(t + 0.004)
        t += 0.008
        assert not arm.moving(t)
        np.testing.assert_allclose(arm.encoder_pose(t).as_matrix(), target.as_matrix(), atol=1e-9)
        assert arm.flange(t).translation[2] < arm.flange(t - 0.004).translation[2], number


def test_a_stream_draws_no_new_error_in_each_tick(scenario: DeckScenario) -> None:
    """The settling error belongs to a motion, and a stream is one: its steps are as even as those
    of a spline."""
    arm, t = at_work(scenario)
    steps = []
    for _ in range(100):
        before = arm.flange(t).translation
        arm.follow(t, shifted(arm, t, -5e-5).as_matrix(), 0.008)
        t += 0.008
        steps.append(arm.flange(t).translation[2] - before[2])
    assert np.std(np.diff(steps)) < 1e-6


def test_a_setpoint_that_is_the_present_pose_moves_nothing(scenario: DeckScenario) -> None:
    arm, t = at_work(scenario)
    arm.follow(t, arm.encoder_matrix(t), 0.008)
    assert not arm.moving(t + 1e-6)


def test_a_setpoint_out_of_reach_is_refused(scenario: DeckScenario) -> None:
    arm, t = at_work(scenario)
    with pytest.raises(RefusedMotionError) as refusal:
        arm.follow(t, from_written([5000, 0, 900, 90, 0, 180]).as_matrix(), 0.008)
    assert refusal.value.reason == "REACH"


def test_a_stop_while_following_over_travels_by_latency_and_ramp(scenario: DeckScenario) -> None:
    arm, t = at_work(scenario)
    speed = 5e-5 / 0.008
    arm.follow(t, shifted(arm, t, -5e-5).as_matrix(), 0.008)
    before = arm.encoder_pose(t + 0.004).translation[2]
    arm.stop(t + 0.004)
    arm.stop(t + 0.1)  # a second request puts nothing off
    settings = scenario.robots["main"]
    latency_s = settings.stop_latency_ms / 1000
    braking = settings.stop_deceleration_mm_s2 / 1000
    assert arm.standstill_s == pytest.approx(t + 0.004 + latency_s + speed / braking)
    over = before - arm.encoder_pose(arm.standstill_s).translation[2]
    assert over == pytest.approx(speed * latency_s + speed**2 / (2 * braking), rel=0.01)


def test_matrices_of_written_poses_are_those_of_the_poses(scenario: DeckScenario) -> None:
    rng = np.random.default_rng(3)
    for _ in range(50):
        written = [*rng.uniform(-2000, 2000, 3), *rng.uniform(-180, 180, 3)]
        near = [value + rng.normal(0, 1e-3) for value in written]
        one, other = written_matrix(written), written_matrix(near)
        np.testing.assert_allclose(one, from_written(written).as_matrix(), atol=1e-12)
        np.testing.assert_allclose(
            matrix_distance(one, other),
            distance(from_written(written), from_written(near)),
            rtol=1e-6,
            atol=1e-12,
        )
