import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.force.compensation import Compensation, RigidLoad, gravity_in_sensor, inertial_wrench
from cellctl.geometry.uncertain import skew
from cellctl.geometry.wrench import Wrench


def load_of(mass_kg: float, centre_m: np.ndarray) -> Compensation:
    force = mass_kg * 9.80665 * np.eye(3)
    return Compensation(np.vstack([force, skew(centre_m) @ force]), np.arange(6.0), "rigid12")


def test_gravity_points_along_plus_z_of_a_sensor_that_hangs_down() -> None:
    down = Rotation.from_euler("ZYX", [90.0, 0.0, 180.0], degrees=True)
    np.testing.assert_allclose(gravity_in_sensor(down), [0.0, 0.0, 1.0], atol=1e-12)


def test_the_load_of_many_orientations_is_that_of_each() -> None:
    rng = np.random.default_rng(1)
    load = load_of(200.0, np.array([0.03, 0.02, 0.4]))
    turned = Rotation.random(7, rng=rng)
    together = load.load(turned)
    for index in range(7):
        np.testing.assert_allclose(together[index], load.load(turned[index]), atol=1e-9)


def test_a_contact_is_what_compensation_leaves() -> None:
    rng = np.random.default_rng(2)
    load = load_of(200.0, np.array([0.03, 0.02, 0.4]))
    turned = Rotation.random(rng=rng)
    contact = np.array([1.0, -2.0, 35.0, 0.5, 0.1, -0.2])
    np.testing.assert_allclose(load.apply(load.load(turned) + contact, turned), contact, atol=1e-9)


def test_transport_to_the_deck_keeps_force_and_moves_the_moment() -> None:
    """A push of 35 N at the middle of a deck 0.44 m below the sensor gives no moment there."""
    sensor_T_deck = RigidTransform.from_components(
        [0.003, -0.002, 0.442], Rotation.from_euler("x", 180.0, degrees=True)
    )
    at_deck = Wrench(np.array([0.0, 0.0, 35.0]), np.zeros(3))
    at_sensor = at_deck.in_frame(sensor_T_deck)
    assert at_sensor.force_n[2] == pytest.approx(-35.0)
    back = at_sensor.in_frame(sensor_T_deck.inv())
    np.testing.assert_allclose(back.vector, at_deck.vector, atol=1e-12)


@pytest.mark.parametrize("acceleration_m_s2", [0.02, 0.05, 0.1, 0.5])
def test_inertia_of_200_kg(acceleration_m_s2: float) -> None:
    """force.md 2.1: 0.02 m/s² is 4 N, 0.05 is 10 N, 0.1 is 20 N, 0.5 is 100 N."""
    load = RigidLoad(200.0, np.array([0.0, 0.0, 0.4]), np.diag([40.0, 45.0, 11.0]))
    still = np.zeros(3)
    felt = inertial_wrench(load, np.array([acceleration_m_s2, 0.0, 0.0]), still, still)
    np.testing.assert_allclose(felt.force_n, [-200.0 * acceleration_m_s2, 0.0, 0.0])
    np.testing.assert_allclose(felt.torque_n_m, [0.0, -80.0 * acceleration_m_s2, 0.0])


def test_a_spinning_load_pulls_outwards() -> None:
    load = RigidLoad(10.0, np.array([0.5, 0.0, 0.0]), np.diag([1.0, 2.0, 3.0]))
    felt = inertial_wrench(load, np.zeros(3), np.zeros(3), np.array([0.0, 0.0, 2.0]))
    np.testing.assert_allclose(felt.force_n, [20.0, 0.0, 0.0])
    np.testing.assert_allclose(felt.torque_n_m, 0.0, atol=1e-12)


def test_shapes_are_checked() -> None:
    with pytest.raises(ValueError, match=r"\(6, 3\)"):
        Compensation(np.zeros((3, 6)), np.zeros(6), "affine24")
