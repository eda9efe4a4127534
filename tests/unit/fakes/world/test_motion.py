import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.world.arm import forward, inverse, nominal_links
from fakes.world.frames import from_written
from fakes.world.motion import JointPath, LinearPath, Profile


def test_trapezoid_takes_the_time_of_its_closed_form() -> None:
    profile = Profile(2.0, 0.1, 0.05, 0.2)
    assert profile.end_s == pytest.approx(2.0 + 0.1 / 0.05 + 0.05 / 0.2)
    assert profile.at(2.0) == 0
    assert profile.at(2.25) == pytest.approx(0.5 * 0.2 * 0.25**2)
    assert profile.at(99) == 0.1


def test_short_way_never_reaches_its_speed() -> None:
    profile = Profile(0.0, 0.001, 0.05, 0.2)
    assert profile.end_s == pytest.approx(2 * np.sqrt(0.001 / 0.2))
    assert profile.at(profile.end_s / 2) == pytest.approx(0.0005)


@pytest.mark.parametrize("stop_s", [0.1, 0.25, 1.0, 2.1])
def test_braked_motion_goes_on_for_v_squared_over_2a(stop_s: float) -> None:
    profile = Profile(0.0, 0.1, 0.05, 0.2)
    braked = profile.stopped_from(stop_s, 0.5)
    rate = (profile.at(stop_s) - profile.at(stop_s - 1e-7)) / 1e-7
    assert braked.cut_short
    assert braked.at(99) - profile.at(stop_s) == pytest.approx(rate**2 / (2 * 0.5), abs=1e-8)
    assert braked.end_s == pytest.approx(stop_s + rate / 0.5, abs=1e-5)


def test_brake_after_the_end_changes_nothing() -> None:
    profile = Profile(0.0, 0.1, 0.05, 0.2)
    late = profile.stopped_from(profile.end_s + 0.01, 0.5)
    assert not late.cut_short
    assert late.at(99) == 0.1


def test_second_brake_does_not_prolong_the_first() -> None:
    braked = Profile(0.0, 0.1, 0.05, 0.2).stopped_from(1.0, 0.5)
    assert braked.stopped_from(1.5, 0.1) is braked
    assert braked.stopped_from(0.8, 0.5).end_s < braked.end_s


def test_position_is_continuous_and_never_runs_back() -> None:
    profile = Profile(0.0, 0.1, 0.05, 0.2).stopped_from(1.3, 0.5)
    places = [profile.at(t) for t in np.arange(0, 3, 1e-3)]
    steps = np.diff(places)
    assert steps.min() >= 0
    assert steps.max() <= 0.05e-3 + 1e-9


def test_linear_path_is_straight_to_a_tenth_of_a_micrometre(scenario: DeckScenario) -> None:
    chain = scenario.robots["main"].chain_mm
    links = nominal_links(chain)
    start = from_written([1250, 0, 1300, 90, 0, 180])
    target = from_written([1900, 200, 967, 80, 3, 178])
    near = inverse(chain, start, np.deg2rad([0, -90, 90, 0, 90, 90]))
    path = LinearPath(chain, start, target, near)
    way = target.translation - start.translation
    direction = way / np.linalg.norm(way)
    for ratio in np.linspace(0, 1, 57):
        offset = forward(links, path.joints(ratio * path.length)).translation - start.translation
        assert np.linalg.norm(np.cross(offset, direction)) < 1e-7
        assert offset @ direction == pytest.approx(ratio * np.linalg.norm(way), abs=1e-7)


def test_pure_turn_takes_time_too(scenario: DeckScenario) -> None:
    chain = scenario.robots["main"].chain_mm
    start = from_written([1900, 0, 967, 90, 0, 180])
    near = inverse(chain, start, np.zeros(6))
    path = LinearPath(chain, start, start * RigidTransform.from_rotation(_turn(0.1)), near)
    assert path.length == pytest.approx(0.025, rel=1e-6)


def test_joint_path_moves_all_joints_together() -> None:
    path = JointPath(np.zeros(6), np.array([1.0, 2, 0, 0, 0, -1]), np.ones(6))
    assert path.length == 2.0
    np.testing.assert_allclose(path.joints(1.0), [0.5, 1, 0, 0, 0, -0.5])


def _turn(angle_rad: float) -> Rotation:
    return Rotation.from_euler("z", angle_rad)
