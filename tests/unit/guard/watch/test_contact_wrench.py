"""The guard's plain floats against the arrays of the rest of the code."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.force.gravity.gravity_compensation import GravityCompensation
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.guard.watch.contact_wrench import ContactWrenchModel
from tests.rigs.sweeps import examples
from tests.unit.guard.watch.wrench import Wrench


def nine(rotation: Rotation) -> tuple[float, ...]:
    return tuple(rotation.as_matrix().ravel().tolist())


@given(st.integers(0, 2**31))
@settings(max_examples=examples(50))
def test_equals_the_formulas_on_arrays(seed: int) -> None:
    rng = np.random.default_rng(seed)
    flange_R_sensor, base_R_flange, sensor_R_wrench = Rotation.random(3, rng=rng)
    sensor_T_wrench = RigidTransform.from_components(rng.normal(0, 0.5, 3), sensor_R_wrench)
    down = rng.normal(size=3)
    load = GravityCompensation(
        rng.normal(0, 1000, (6, 3)),
        rng.normal(0, 50, 6),
        "affine24",
        base_down=tuple(down / np.linalg.norm(down)),
    )
    raw = rng.normal(0, 1000, 6)
    tare = rng.normal(0, 10, 6)

    model = ContactWrenchModel(nine(flange_R_sensor))
    model.set_flange(nine(base_R_flange))
    model.set_gravity_compensation(load.A.tolist(), load.b.tolist(), load.base_down)
    model.set_wrench_frame(nine(sensor_R_wrench), sensor_T_wrench.translation.tolist())
    model.set_tare(tuple(tare.tolist()))

    contact = Wrench.from_vector(load.apply(raw, base_R_flange * flange_R_sensor))
    expected = contact.in_frame(sensor_T_wrench.inv()).vector - tare
    assert model.apply(tuple(raw.tolist())) == pytest.approx(expected, rel=1e-9, abs=1e-7)
    assert model.untared(model.apply(tuple(raw.tolist()))) == pytest.approx(
        expected + tare, rel=1e-9, abs=1e-7
    )


def test_a_new_frame_or_load_drops_the_tare() -> None:
    model = ContactWrenchModel()
    changes: tuple[Callable[[], None], ...] = (
        lambda: model.set_wrench_frame(nine(Rotation.identity()), (0.0, 0.0, 0.0)),
        lambda: model.set_gravity_compensation([(0.0, 0.0, 0.0)] * 6, (0.0,) * 6, (0.0, 0.0, -1.0)),
    )
    for change in changes:
        model.set_tare((1.0,) * 6)
        change()
        assert model.apply((0.0,) * 6) == (0.0,) * 6


def test_a_wrench_keeps_its_power_in_any_frame() -> None:
    rng = np.random.default_rng(1)
    wrench = Wrench.from_vector(rng.normal(size=6))
    b_T_a = pose_from_xyzabc([120, -340, 560, 20, -50, 75])
    velocity_a, rate_a = rng.normal(size=3), rng.normal(size=3)
    rate_b = b_T_a.rotation.apply(rate_a)
    velocity_b = b_T_a.rotation.apply(velocity_a) - np.cross(rate_b, b_T_a.translation)
    moved = wrench.in_frame(b_T_a)
    before = wrench.force_n @ velocity_a + wrench.torque_n_m @ rate_a
    assert moved.force_n @ velocity_b + moved.torque_n_m @ rate_b == pytest.approx(before)


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
