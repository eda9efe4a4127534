"""A peg in the fingers of an arm is jogged into its hole by somebody who knows where it is."""

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from fakes.scenes.registry import scene_class
from fakes.scenes.socket.part import draw_part
from fakes.scenes.socket.scenario import SocketScenario
from fakes.scenes.socket.scene import SocketScene
from fakes.world.arm import inverse
from fakes.world.frames import MM, displacement, from_written, inverse_matrix
from fakes.world.peg.attitude import pose_of
from tests.rigs.sweeps import sweep

CONFIG = Path(__file__).parents[5] / "config"
CELLS = ("connector", "pin")


def _scenario(cell: str) -> SocketScenario:
    """The scenario with an arm that comes to where it is jogged."""
    read = SocketScenario.read(CONFIG / f"insertion-{cell}.scenario.toml")
    exact = {"repeatability_mm": 0.0, "repeatability_deg": 0.0}
    return read.model_copy(update={"robots": {"arm": read.robots["arm"].model_copy(update=exact)}})


@pytest.fixture(scope="module", params=sweep(CELLS, ("connector",)))
def scenario(request: pytest.FixtureRequest) -> SocketScenario:
    return _scenario(request.param)


def _above(scenario: SocketScenario, seed: int = 1) -> SocketScene:
    """The world with its arm above the hole."""
    world = SocketScene(scenario, seed)
    arm = world.arms["arm"]
    flange = from_written(scenario.taught["arm"]["above_hole"])
    joints = inverse(arm.settings.chain_mm, flange, arm.joints(0.0))
    arm.start_joint(world.time_s, joints, 100)
    world.advance(arm.standstill_s + 0.2)
    return world


def _jog(world: SocketScene, x_mm: float, y_mm: float, z_mm: float, speed_mm_s: float) -> None:
    """The free tip to a true place in the hole's frame, upright in it."""
    tip = RigidTransform.from_translation(np.array([x_mm, y_mm, z_mm]) * MM)
    flange = world.part.cell_T_hole * tip * world.part.flange_T_peg.inv()
    arm = world.arms["arm"]
    arm.start_jog(world.time_s, flange, speed_mm_s * MM)
    world.advance(arm.standstill_s + 0.05)


def test_the_entry_point_of_the_scene_is_this_class() -> None:
    assert scene_class("socket") is SocketScene


def test_taught_poses_of_the_cell_files_are_those_of_the_scenarios() -> None:
    for cell in CELLS:
        taught = tomllib.loads((CONFIG / f"insertion-{cell}.toml").read_text(encoding="utf-8"))
        joints = _above(_scenario(cell)).arms["arm"].joints(100.0)
        expected = taught["robots"]["arm"]["poses_deg"]["above_hole"]
        np.testing.assert_allclose(np.rad2deg(joints), expected, atol=1e-5)


def test_in_the_air_the_sensor_feels_the_weight_alone(scenario: SocketScenario) -> None:
    world = _above(scenario)
    truth = world.report()
    assert not truth["touching"]
    assert truth["peak_force_n"] == {"1_ms": 0.0, "3_ms": 0.0, "20_ms": 0.0}
    load = world.load_on("force", world.sensors["force"].flange, moving=False)
    assert np.linalg.norm(load[:3]) == pytest.approx(9.80665 * scenario.peg.mass_kg, rel=1e-5)


def test_a_peg_that_is_let_down_over_its_hole_reaches_the_seat(scenario: SocketScenario) -> None:
    world = _above(scenario)
    depth_mm = scenario.fit.depth_mm
    _jog(world, 0.0, 0.0, 2.0, 20.0)
    assert not world.report()["touching"]
    inside_n = scenario.fit.contacts[-1][1] if scenario.fit.contacts else 0.0
    bent_mm = (inside_n + 10.0) / scenario.compliance.axial_n_m / MM
    _jog(world, 0.02, 0.0, -depth_mm - bent_mm, 8.0)
    truth = world.report()
    assert truth["seated"]
    assert truth["depth_mm"] == pytest.approx(depth_mm, abs=0.05)
    assert truth["unsolved_steps"] <= 2  # at most at the step that reaches the seat
    peak_n = truth["peak_force_n"]
    assert inside_n + 8.0 < peak_n["20_ms"] <= peak_n["1_ms"] + 1e-9


def test_the_sensor_feels_the_force_on_the_peg_with_its_lever(scenario: SocketScenario) -> None:
    world = _above(scenario)
    _jog(world, 0.0, 0.0, 2.0, 20.0)
    free = world.load_on("force", world.sensors["force"].flange, moving=False)
    # Beside the hole on the face, and pushed on sideways.
    beside_mm = scenario.fit.bore_radius_mm + 0.9
    _jog(world, beside_mm, 0.0, 1.0, 10.0)
    _jog(world, beside_mm, 0.0, -0.08, 2.0)
    _jog(world, beside_mm + 0.2, 0.0, -0.08, 2.0)
    load = world.load_on("force", world.sensors["force"].flange, moving=False) - free
    on_peg = np.array(world.report()["force_n"])
    assert on_peg[2] == pytest.approx(8.0, rel=0.25)
    assert -on_peg[0] == pytest.approx(scenario.fit.friction * on_peg[2], rel=0.05)
    sensor = from_written(world.report()["cell_T_flange_mm_deg"]) * (
        world.truth.force_sensors["force"].flange_T_sensor
    )
    hole = world.part.cell_T_hole
    force = sensor.rotation.inv().apply(hole.rotation.apply(on_peg[:3]))
    np.testing.assert_allclose(load[:3], force, atol=0.02)
    tip = sensor.inv().apply(hole.apply(np.array(world.report()["hole_T_tip_mm"]) * MM))
    torque = np.cross(tip, force) + sensor.rotation.inv().apply(hole.rotation.apply(on_peg[3:]))
    np.testing.assert_allclose(load[3:], torque, atol=0.01)


@pytest.mark.parametrize(
    ("fault", "parameters", "depth_mm"),
    [
        pytest.param("hole_absent", {}, 0.0, marks=pytest.mark.figures),
        ("blocked", {"depth_mm": 5.0}, 5.0),
        pytest.param("wrong_size", {"by_mm": 0.1}, 0.95, marks=pytest.mark.figures),
    ],
)
def test_a_hole_that_is_not_as_it_should_be_stops_the_peg(
    fault: str, parameters: dict[str, float], depth_mm: float
) -> None:
    world = _above(_scenario("pin"))
    world.faults.inject(fault, count=None, **parameters)
    world.faults_changed()
    _jog(world, 0.0, 0.0, 1.0, 20.0)
    _jog(world, 0.0, 0.0, -depth_mm - 0.1, 5.0)
    truth = world.report()
    assert -truth["hole_T_tip_mm"][2] == pytest.approx(depth_mm, abs=0.02)
    assert truth["force_n"][2] == pytest.approx(10.0, rel=0.25)
    assert not truth["seated"]


def test_in_a_wider_hole_the_peg_is_not_seated_however_deep() -> None:
    world = _above(_scenario("pin"))
    world.faults.inject("wrong_hole")
    world.faults_changed()
    _jog(world, 0.0, 0.0, 1.0, 20.0)
    _jog(world, 0.0, 0.0, -11.9, 20.0)
    truth = world.report()
    assert truth["depth_mm"] == pytest.approx(11.9, abs=0.05)
    assert truth["hole_faults"] == ["wrong_hole"]
    assert not truth["seated"]


def test_weak_fingers_let_the_peg_slip() -> None:
    world = _above(_scenario("pin"))
    world.faults.inject("peg_slip", grip_n=8.0)
    world.faults_changed()
    _jog(world, 8.0, 0.0, 1.0, 20.0)
    _jog(world, 8.0, 0.0, -1.0, 2.0)
    truth = world.report()
    assert truth["slip_mm"] == pytest.approx(1.0 - 0.08, abs=0.05)
    assert truth["peak_force_n"]["20_ms"] < 9.0
    assert not truth["seated"]


def test_without_its_groove_the_plug_stands_on_its_keys() -> None:
    world = _above(_scenario("connector"))
    world.faults.inject("key_missing")
    world.faults_changed()
    _jog(world, 0.0, 0.0, 1.0, 20.0)
    _jog(world, 0.0, 0.0, -3.1, 5.0)
    assert world.report()["depth_mm"] == pytest.approx(3.0, abs=0.02)


def test_a_seed_gives_the_same_run_and_another_one_another_hole(scenario: SocketScenario) -> None:
    truths = []
    for seed in (5, 5, 6):
        world = _above(scenario, seed)
        _jog(world, 0.3, 0.0, 1.0, 20.0)
        _jog(world, 0.3, 0.0, -1.5, 8.0)
        truths.append(world.report())
    assert truths[0] == truths[1]
    assert truths[0]["cell_T_hole_mm_deg"] != truths[2]["cell_T_hole_mm_deg"]


def test_every_load_brings_another_hole_with_fresh_peaks() -> None:
    world = _above(_scenario("pin"))
    first = world.part.cell_T_hole.translation
    _jog(world, 0.5, 0.0, -0.6, 10.0)
    assert world.report()["peak_force_n"]["1_ms"] > 0
    assert world.commands()["load"]() == {"load": 2}
    assert np.linalg.norm(world.part.cell_T_hole.translation - first) > 1e-5
    assert world.peaks.force_n[1] == 0.0


@pytest.mark.figures
def test_holes_lie_within_their_radius_as_often_as_the_scenario_says(
    scenario: SocketScenario,
) -> None:
    said = from_written(scenario.socket.cell_T_hole_mm_deg)
    off = [said.inv() * draw_part(scenario, 1, number).cell_T_hole for number in range(800)]
    side_mm = np.array([math.hypot(*one.translation[:2]) / MM for one in off])
    outside = int((side_mm > scenario.socket.lateral_p99_mm).sum())
    assert 1 <= outside <= 20  # 8 are expected of 800
    assert np.median(side_mm) == pytest.approx(scenario.socket.lateral_p99_mm * 0.388, rel=0.1)
    heights = [abs(one.translation[2]) / MM for one in off]
    assert max(heights) <= scenario.socket.height_spread_mm


def test_the_peg_in_its_fingers_turns_with_the_flange(scenario: SocketScenario) -> None:
    world = _above(scenario)
    flange = world.flange("arm") * displacement([0, 0, 0], [0.0, 0.0, math.radians(10.0)])
    hole = inverse_matrix(world.part.cell_T_hole.as_matrix())
    turned = pose_of(hole @ (flange * world.part.flange_T_peg).as_matrix())
    # z of the flange points down: a turn to the right seen from above
    assert math.degrees(world.peg.pose[5] - turned[5]) == pytest.approx(10.0, abs=0.05)
