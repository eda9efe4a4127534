import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.world.arm import OutOfReachError, forward, inverse, nominal_links, singular
from fakes.world.frames import distance, from_written, to_written
from fakes.world.truth import draw

ROBOTS = ("main", "aux_1", "aux_2")


@pytest.mark.parametrize("name", ROBOTS)
def test_inverse_undoes_forward_over_the_whole_joint_space(
    scenario: DeckScenario, name: str
) -> None:
    chain, rng = scenario.robots[name].chain_mm, np.random.default_rng(1)
    low, high = np.deg2rad(np.array(scenario.robots[name].limits_deg)).T
    for _ in range(200):
        joints = rng.uniform(low, high)
        found = inverse(chain, forward(nominal_links(chain), joints), joints)
        np.testing.assert_allclose(found, joints, atol=1e-7)


@pytest.mark.parametrize("name", ROBOTS)
def test_inverse_from_elsewhere_still_reaches_the_pose(scenario: DeckScenario, name: str) -> None:
    chain, rng = scenario.robots[name].chain_mm, np.random.default_rng(2)
    low, high = np.deg2rad(np.array(scenario.robots[name].limits_deg)).T
    for _ in range(100):
        pose = forward(nominal_links(chain), rng.uniform(low, high))
        joints = inverse(chain, pose, rng.uniform(low, high))
        distance_m, angle_rad = distance(forward(nominal_links(chain), joints), pose)
        assert distance_m < 1e-9
        assert angle_rad < 1e-7


def test_stretched_arm_by_hand(scenario: DeckScenario) -> None:
    chain = scenario.robots["main"].chain_mm
    x, y, z, *_ = to_written(forward(nominal_links(chain), np.zeros(6)))
    assert x == pytest.approx(chain.a1 + chain.a2 + chain.d4 + chain.d6)
    assert y == pytest.approx(0)
    assert z == pytest.approx(chain.d1 + chain.elbow)


def test_first_axis_is_base_z_and_second_is_horizontal_at_its_height(
    scenario: DeckScenario,
) -> None:
    chain = scenario.robots["main"].chain_mm
    links = nominal_links(chain)
    steps = np.deg2rad([[a, -60, 90, 0, 30, 0] for a in (-30, 0, 30)])
    places = np.array([forward(links, joints).translation for joints in steps])
    assert np.ptp(places[:, 2]) < 1e-12
    assert np.ptp(np.hypot(places[:, 0], places[:, 1])) < 1e-12
    steps = np.deg2rad([[0, a, 90, 0, 30, 0] for a in (-80, -60, -40)])
    places = np.array([forward(links, joints).translation for joints in steps])
    centre = np.array([chain.a1, 0.0, chain.d1]) / 1000
    assert np.ptp(np.linalg.norm(places - centre, axis=1)) < 1e-12
    assert np.ptp(places[:, 1]) < 1e-12


def test_too_far_is_out_of_reach(scenario: DeckScenario) -> None:
    with pytest.raises(OutOfReachError):
        inverse(
            scenario.robots["main"].chain_mm,
            RigidTransform.from_translation([9, 0, 1]),
            np.zeros(6),
        )


def test_kinematic_error_has_the_intended_size(scenario: DeckScenario) -> None:
    """0.5 to 1 mm and 0.05° over the workspace, from seed to seed."""
    robot = scenario.robots["main"]
    nominal, home = nominal_links(robot.chain_mm), np.deg2rad(robot.home_deg)
    errors = []
    for seed in range(30):
        true = draw(scenario, seed).robots["main"].links
        rng = np.random.default_rng(seed)
        for _ in range(6):
            joints = home + np.deg2rad(rng.uniform(-40, 40, 6))
            errors.append(distance(forward(nominal, joints), forward(true, joints)))
    millimetres, degrees = np.array(errors).T * [[1e3], [180 / np.pi]]
    assert 0.6 < np.median(millimetres) < 1.1
    assert np.percentile(millimetres, 95) < 2.2
    assert 0.03 < np.median(degrees) < 0.07


def test_taught_poses_are_inside_the_limits_and_away_from_singularities(
    scenario: DeckScenario,
) -> None:
    for name in ROBOTS:
        robot = scenario.robots[name]
        low, high = np.deg2rad(np.array(robot.limits_deg)).T
        joints = np.deg2rad(np.array(robot.home_deg))
        for written in scenario.taught[name].values():
            pose = from_written(robot.base_mm_deg).inv() * from_written(written)
            joints = inverse(robot.chain_mm, pose, joints)
            assert (joints > low).all()
            assert (joints < high).all()
            assert not singular(joints)
