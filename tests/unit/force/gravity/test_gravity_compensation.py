import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cellctl.force.gravity.gravity_compensation import GravityCompensation, gravity_in_sensor
from cellctl.geometry.uncertain import skew


def load_of(mass_kg: float, centre_m: np.ndarray) -> GravityCompensation:
    force = mass_kg * 9.80665 * np.eye(3)
    return GravityCompensation(
        np.vstack([force, skew(centre_m) @ force]), np.arange(6.0), "rigid12"
    )


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


def test_shapes_are_checked() -> None:
    with pytest.raises(ValueError, match=r"\(6, 3\)"):
        GravityCompensation(np.zeros((3, 6)), np.zeros(6), "affine24")
