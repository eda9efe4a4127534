import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cellctl.errors.calibration import CalibrationRecordInvalid
from cellctl.force.gravity.acceptance import PayloadLimits
from cellctl.force.gravity.payload import fit_affine24, fit_rigid12, identify_payload
from cellctl.force.gravity.payload_result import (
    evaluate_payload,
    gravity_compensation_from_document,
    mass_kg,
    payload_document,
)
from cellctl.force.gravity.signs import reaction_check
from tests.rigs.payload_world import (
    LoadedSensor,
    compensation_of,
    cone,
    imperfect,
    record,
    rotations,
)


def tumble(count: int, rng: np.random.Generator) -> Rotation:
    return Rotation.random(count, rng=rng)


def test_rigid12_finds_the_load_of_an_ideal_sensor_exactly() -> None:
    rng = np.random.default_rng(1)
    sensor = LoadedSensor()
    turned = rotations(cone())
    found = fit_rigid12(turned, sensor.read(turned, rng))
    assert found.mass_kg == pytest.approx(200.0, rel=1e-9)
    np.testing.assert_allclose(found.centre_of_mass_m, sensor.centre_m, atol=1e-9)
    np.testing.assert_allclose(found.force_offset_n, sensor.offset[:3], atol=1e-6)
    np.testing.assert_allclose(found.torque_offset_n_m, sensor.offset[3:], atol=1e-6)
    assert found.inclination_u_rad == pytest.approx(0.0, abs=1e-9)
    assert not found.reads_reaction
    assert reaction_check(found).passed


@pytest.mark.parametrize("u_deg", [-2.0, 0.0, 1.5])
@pytest.mark.parametrize("v_deg", [-1.0, 3.0])
def test_rigid12_finds_the_inclination_in_the_u_v_form(u_deg: float, v_deg: float) -> None:
    rng = np.random.default_rng(2)
    u, v = np.deg2rad([u_deg, v_deg])
    up = np.array([np.cos(u) * np.sin(v), -np.sin(u), np.cos(u) * np.cos(v)])
    tilt, _ = Rotation.align_vectors([up], [[0.0, 0.0, 1.0]])
    turned = tumble(20, rng)
    found = fit_rigid12(turned, LoadedSensor(base_tilt=tilt).read(turned, rng))
    assert np.rad2deg(found.inclination_u_rad) == pytest.approx(u_deg, abs=1e-6)
    assert np.rad2deg(found.inclination_v_rad) == pytest.approx(v_deg, abs=1e-6)


def test_a_sensor_that_states_reactions_is_recognised() -> None:
    rng = np.random.default_rng(3)
    turned = tumble(16, rng)
    found = fit_rigid12(turned, -LoadedSensor(offset=np.zeros(6)).read(turned, rng))
    assert found.reads_reaction
    assert not reaction_check(found).passed
    assert found.mass_kg == pytest.approx(200.0)
    assert found.inclination_v_rad == pytest.approx(0.0, abs=1e-9)
    left = compensation_of(found).apply(-LoadedSensor(offset=np.zeros(6)).read(turned, rng), turned)
    np.testing.assert_allclose(left, 0.0, atol=1e-6)


def test_affine24_absorbs_what_rigid12_cannot_near_the_mating_orientation() -> None:
    """Monte-Carlo like table 2.4: compensated force within 3° of the mating pose."""
    rng = np.random.default_rng(4)
    left: dict[str, list[float]] = {"affine24": [], "rigid12": []}
    axial: list[float] = []
    for _ in range(60):
        sensor = imperfect(rng)
        turned = rotations(cone())
        readings = sensor.read(turned, rng)
        near = Rotation.from_rotvec(rng.normal(0.0, np.deg2rad(1.5), (8, 3))) * turned[0]
        wrenches = sensor.read(near, rng)
        for model in (
            fit_affine24(turned, readings).compensation,
            compensation_of(fit_rigid12(turned, readings)),
        ):
            rest = model.apply(wrenches, near)
            left[model.method] += np.linalg.norm(rest[:, :3], axis=1).tolist()
            if model.method == "affine24":
                axial += np.abs(rest[:, 2]).tolist()
    assert np.percentile(left["affine24"], 95) < 1.5
    assert np.percentile(axial, 95) < 0.7
    assert np.percentile(left["rigid12"], 95) > 2.0 * np.percentile(left["affine24"], 95)


def test_leave_one_out_residuals_are_those_of_refitting() -> None:
    rng = np.random.default_rng(5)
    turned = rotations(cone())
    readings = LoadedSensor(noise=np.full(6, 0.3)).read(turned, rng)
    affine = fit_affine24(turned, readings)
    for index in (0, 5, len(readings) - 2):
        others = np.delete(np.arange(len(readings)), index)
        model = fit_affine24(turned[others], readings[others]).compensation
        expected = model.apply(readings[index], turned[index])
        np.testing.assert_allclose(affine.left_out[index], expected, atol=1e-6)


def test_a_base_that_is_not_level_is_told_from_wide_poses() -> None:
    rng = np.random.default_rng(6)
    tilt = Rotation.from_rotvec(np.deg2rad([1.0, -2.0, 0.0]))
    sensor = LoadedSensor(base_tilt=tilt)
    turned = tumble(20, rng)
    found = identify_payload(turned, sensor.read(turned, rng))
    assert found.excitation.wide
    np.testing.assert_allclose(found.affine.residual, 0.0, atol=1e-6)
    np.testing.assert_allclose(
        found.affine.compensation.base_down, tilt.apply([0.0, 0.0, -1.0]), atol=1e-9
    )


@pytest.mark.parametrize("seed", range(12))
def test_a_good_record_is_accepted_and_read_back(seed: int) -> None:
    rng = np.random.default_rng(seed)
    result = evaluate_payload(record(imperfect(rng), rng), expected_mass_kg=200.0)
    assert result.accepted, [str(check) for check in result.checks]
    again = gravity_compensation_from_document(payload_document(result))
    np.testing.assert_array_equal(again.A, result.compensation.A)
    np.testing.assert_array_equal(again.b, result.compensation.b)
    assert again.method == result.compensation.method == "affine24"
    assert again.residual_n == result.compensation.residual_n
    assert again.residual_n_m == result.compensation.residual_n_m
    assert again.base_down == result.compensation.base_down


def test_identifying_without_the_deck_is_rejected_by_mass() -> None:
    rng = np.random.default_rng(8)
    result = evaluate_payload(record(LoadedSensor(mass_kg=150.0), rng), expected_mass_kg=200.0)
    assert [check.name for check in result.checks if not check.passed] == ["mass against CAD"]


def test_the_mass_is_read_back_from_the_record() -> None:
    result = evaluate_payload(record(LoadedSensor(), np.random.default_rng(3)))
    assert mass_kg(payload_document(result)) == result.identification.rigid.mass_kg
    with pytest.raises(CalibrationRecordInvalid, match="no mass"):
        mass_kg({"accepted": True})


def test_drift_between_first_and_last_pose_is_rejected() -> None:
    rng = np.random.default_rng(9)
    data = record(LoadedSensor(), rng)
    data.wrenches[-1, 0] += 3.0
    result = evaluate_payload(data)
    assert [check.name for check in result.checks if not check.passed] == [
        "drift of the repeated pose"
    ]


def test_a_hose_that_pulls_shows_in_the_hold_out_poses() -> None:
    rng = np.random.default_rng(10)
    data = record(LoadedSensor(), rng)
    data.wrenches[13] += np.array([8.0, 0.0, 0.0, 0.0, 3.0, 0.0])
    names = [check.name for check in evaluate_payload(data).checks if not check.passed]
    assert names == ["hold-out force", "hold-out torque"]


def test_limits_of_wide_poses_are_the_narrow_ones() -> None:
    rng = np.random.default_rng(11)
    turned = tumble(24, rng)
    tilted = LoadedSensor(base_tilt=Rotation.from_rotvec(np.deg2rad([0.8, 0.0, 0.0])))
    data = record(LoadedSensor(), rng)
    wide = type(data)(turned, tilted.read(turned, rng), (data.roles[0],) * 24)
    result = evaluate_payload(wide, limits=PayloadLimits())
    assert [check.name for check in result.checks if not check.passed] == ["inclination U"]
