"""A module is gripped, weighed, looked at from below, and plugged; no wire in between."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import pose_error
from cellctl.processes.antenna_module.connector.connector import read_connector
from cellctl.processes.antenna_module.vision.measure import measure_connector
from cellctl.processes.antenna_module.vision.plane import PlaneCalibration, facing_camera
from fakes.render.connectors import api
from fakes.scenes.antenna_bench.scenario import BenchScenario
from fakes.scenes.antenna_bench.scene import AntennaBench
from fakes.world.arm import inverse
from fakes.world.connector.drawing import SOCKET_T_MATED_PLUG
from fakes.world.connector.scene import SceneConnector, SceneMarks
from fakes.world.frames import distance, from_written
from fakes.world.scene import MonoTruth, ScenePlate
from tests.rigs.antenna.pictures import exact_model
from tests.rigs.sweeps import sweep
from tests.unit.fakes.scenes.antenna_bench.placed_arm import bench_at

CONFIG = Path(__file__).parents[5] / "config"
G_M_S2 = 9.80665


def test_the_taught_poses_of_the_cell_file_are_those_of_the_scenario(
    scenario: BenchScenario,
) -> None:
    arm = AntennaBench(scenario, 1).arms["arm"]
    cell = tomllib.loads((CONFIG / "antenna.toml").read_text(encoding="utf-8"))
    taught_deg = cell["robots"]["arm"]["poses_deg"]
    for name, pose in scenario.taught["arm"].items():
        joints = inverse(arm.settings.chain_mm, from_written(pose), arm.joints(0.0))
        np.testing.assert_allclose(np.rad2deg(joints), taught_deg[name], atol=1e-5)


class Hands:
    """Drives the bench as somebody who knows the truth."""

    def __init__(self, world: AntennaBench) -> None:
        self.world, self.arm = world, world.arms["arm"]

    def taught(self, name: str) -> None:
        self.joints_to(from_written(self.world.scenario.taught["arm"][name]))

    def joints_to(self, target: RigidTransform) -> None:
        joints = inverse(self.arm.settings.chain_mm, target, self.arm.joints(self.world.time_s))
        self.arm.start_joint(self.world.time_s, joints, 100)
        self.wait(self.arm.standstill_s - self.world.time_s + 0.01)

    def true_flange_to(self, cell_T_flange: RigidTransform) -> None:
        """Correct the arm by its error here; twice, because a long way has another error."""
        for _ in range(2):
            commanded = self.arm.encoder_pose(self.world.time_s)
            off = commanded * self.world.flange("arm").inv()
            self.joints_to(off * cell_T_flange)

    def wait(self, seconds: float) -> None:
        self.world.advance(self.world.time_s + seconds)

    def jaws(self, *, close: bool) -> None:
        jaws = self.world.jaws["gripper"]
        jaws.drive(self.world.time_s, open_coil=not close, close_coil=close)
        for _ in range(30):
            self.wait(0.01)
            jaws.position(self.world.time_s)

    def grip(self) -> None:
        self.taught("above_tray")
        self.true_flange_to(self.over_module())
        self.jaws(close=True)
        self.taught("above_tray")

    def over_module(self) -> RigidTransform:
        nominal = from_written(self.world.scenario.gripper.flange_T_plug_mm_deg)
        return self.world.parts.cell_T_tray_plug * nominal.inv()

    def plug_at(self, depth_m: float, aside_m: float = 0.0) -> RigidTransform:
        """cell_T_flange with the held plug at a depth in the socket."""
        place = RigidTransform.from_translation([aside_m, 0.0, -depth_m]) * SOCKET_T_MATED_PLUG
        return self.world.parts.cell_T_socket * place * self.world.module.flange_T_plug.inv()

    def force_z(self) -> float:
        """Raw reading of the sensor's z, mean over half a second: its hum has 14 Hz."""
        begin_s = self.world.time_s
        times = begin_s + 0.01 + np.arange(100) * 0.005
        return float(np.mean([self.world.sensor_wrench("force", t)[2] for t in times]))


def held(scenario: BenchScenario, seed: int = 3) -> Hands:
    """Hands before the socket with the module in the fingers, because the way there takes long."""
    hands = Hands(bench_at(scenario, "above_socket", seed))
    hands.world.module.place = "gripper"
    jaws = hands.world.jaws["gripper"]
    jaws.part_present = True
    jaws.drive(0.0, open_coil=False, close_coil=True)
    jaws.position(1.0)
    return hands


def test_the_module_hangs_and_is_weighed(scenario: BenchScenario) -> None:
    hands = Hands(bench_at(scenario, "above_tray", 3))
    empty_n = hands.force_z()
    hands.grip()
    assert hands.world.truth_report()["module"] == "gripper"
    # The sensor's z points down with the flange.
    assert hands.force_z() - empty_n == pytest.approx(scenario.module.mass_kg * G_M_S2, abs=0.1)


def test_a_module_that_was_gripped_off_its_place_slides_back_into_its_pocket(
    scenario: BenchScenario,
) -> None:
    world = bench_at(scenario, "above_tray", 3)
    hands, pocket = Hands(world), world.parts.cell_T_tray_plug
    nominal = from_written(scenario.gripper.flange_T_plug_mm_deg)
    world.faults.inject("grip_off", count=1, x_mm=2.0, yaw_deg=1.0)
    hands.true_flange_to(hands.over_module())
    hands.jaws(close=True)
    assert world.truth_report()["module"] == "gripper"
    away_m, _ = distance(nominal, world.module.flange_T_plug)
    assert away_m == pytest.approx(2.0e-3, abs=0.1e-3)
    hands.jaws(close=False)
    assert world.truth_report()["module"] == "tray"
    assert distance(world.module.cell_T_plug, pocket) == pytest.approx((0.0, 0.0), abs=1e-12)
    hands.jaws(close=True)
    away_m, _ = distance(nominal, world.module.flange_T_plug)
    assert away_m < 0.3e-3


def test_jaws_close_beyond_nothing(scenario: BenchScenario) -> None:
    hands = Hands(bench_at(scenario, "above_tray", 3))
    hands.jaws(close=True)
    assert hands.world.jaws["gripper"].last_position == 1.0
    assert hands.world.truth_report()["module"] == "tray"


def test_what_the_cameras_see(scenario: BenchScenario) -> None:
    hands = Hands(bench_at(scenario, "tray_look", 4))
    tray, top = hands.world.camera_scene("camera_1").bodies
    assert isinstance(tray, ScenePlate)
    assert isinstance(top, ScenePlate)
    assert (tray.name, top.name) == ("tray", "module")
    assert tray.camera_T_part.translation[2] > top.camera_T_part.translation[2]
    hands.grip()
    hands.taught("inspect_plug")
    plug, marks, dots = hands.world.camera_scene("camera_2").bodies
    assert isinstance(plug, SceneConnector)
    assert isinstance(marks, SceneMarks)
    assert plug.kind == "pins"
    assert isinstance(dots, SceneMarks)
    assert plug.camera_T_connector.translation == pytest.approx([0.0, 0.0, 0.25], abs=3e-3)
    hands.taught("socket_look")
    (socket,) = hands.world.camera_scene("camera_1").bodies
    assert isinstance(socket, SceneConnector)
    assert socket.kind == "holes"


def test_a_good_plug_goes_in_seats_and_stays(scenario: BenchScenario) -> None:
    hands = held(scenario)
    tare_n = hands.force_z()
    hands.true_flange_to(hands.plug_at(-0.3e-3))
    for depth_mm in np.arange(0.0, 2.55, 0.15):
        hands.joints_to(hands.arm.encoder_pose(hands.world.time_s) * _down(0.15e-3))
        report = hands.world.truth_report()
        assert report["seated_depth_mm"] == pytest.approx(depth_mm - 0.15, abs=0.12)
    report = hands.world.truth_report()
    assert set(report["pins"].values()) == {"inside"}
    assert report["offset_at_worst_contact_mm"] < 0.06
    peaks_n = hands.world.parts.pair.peaks_n.sum()
    # The sensor's z points down, the socket pushes up.
    assert 0.5 * peaks_n < tare_n - hands.force_z() < 1.2 * peaks_n
    hands.jaws(close=False)
    assert hands.world.truth_report()["module"] == "socket"


def with_d_sub(scenario: BenchScenario) -> BenchScenario:
    module = scenario.module.model_copy(update={"connector": "d-sub-15"})
    return scenario.model_copy(update={"module": module})


def test_a_d_sub_goes_in_as_deep_as_its_drawing_says_and_stays(scenario: BenchScenario) -> None:
    hands = held(with_d_sub(scenario))
    drawn = read_connector(CONFIG / "connectors" / "d-sub-15-holes.toml")
    hands.true_flange_to(hands.plug_at(-0.3e-3))
    for _ in range(round((0.3e-3 + drawn.seat_depth_m) / 0.3e-3)):
        hands.joints_to(hands.arm.encoder_pose(hands.world.time_s) * _down(0.3e-3))
    report = hands.world.truth_report()
    assert set(report["pins"].values()) == {"inside"}
    assert report["seated_depth_mm"] == pytest.approx(drawn.seat_depth_m * 1e3, abs=0.12)
    assert report["seat_depth_mm"] == pytest.approx(drawn.seat_depth_m * 1e3)
    hands.jaws(close=False)
    assert hands.world.truth_report()["module"] == "socket"


@pytest.mark.parametrize(
    ("pose", "camera", "kind"),
    sweep(
        (("inspect_plug", "camera_2", "pins"), ("socket_look", "camera_1", "holes")),
        (("socket_look", "camera_1", "holes"),),
    ),
)
def test_a_d_sub_is_measured_in_what_the_cameras_see(
    scenario: BenchScenario, pose: str, camera: str, kind: str
) -> None:
    world = bench_at(with_d_sub(scenario), pose, 3)
    world.module.place = "gripper"
    scene = world.camera_scene(camera)
    body = next(one for one in scene.bodies if isinstance(one, SceneConnector))
    assert (body.name, body.kind) == ("d-sub-15", kind)
    optics = scene.optics
    assert isinstance(optics, MonoTruth)
    picture = api.render(optics, (body,), seed=1)
    model = exact_model(optics)
    # z of the plane away from the camera, that of the connector towards it.
    plane = PlaneCalibration(model.id, facing_camera(body.camera_T_connector), 2e-4, 2e-3, None)
    drawn = read_connector(CONFIG / "connectors" / f"d-sub-15-{kind}.toml")
    found = measure_connector(picture.image, model, plane, drawn)
    assert all(contact.state == "ok" for contact in found.contacts)
    shift, turn = pose_error(body.camera_T_connector, found.camera_T_connector.pose)
    # Fifteen contacts with a true position of 10 µm; the rim of a hole appears a little deeper.
    assert np.linalg.norm(shift[:2]) < 15e-6
    assert abs(turn[2]) < np.radians(0.1)


def test_an_offset_is_felt_before_the_springs(scenario: BenchScenario) -> None:
    hands = held(scenario)
    tare_n = hands.force_z()
    hands.true_flange_to(hands.plug_at(-0.05e-3, aside_m=0.15e-3))
    felt_n = []
    for _ in range(5):
        hands.joints_to(hands.arm.encoder_pose(hands.world.time_s) * _down(0.07e-3))
        felt_n.append(tare_n - hands.force_z())
    assert max(felt_n) > 2.0
    assert hands.world.truth_report()["seated_depth_mm"] < 0.5
    assert hands.world.truth_report()["pins"]["1"] == "inside"


def test_injected_flaws_are_those_of_the_next_parts(scenario: BenchScenario) -> None:
    world = AntennaBench(scenario, 1)
    world.faults.inject("bent_pin", contact="4", x_mm=0.3)
    world.faults.inject("missing_pin", contact="9")
    world.faults.inject("blocked_hole", contact="2")
    seat_mm = world.truth_report()["seat_depth_mm"]
    world.faults.inject("foreign_body", early_mm=0.4)
    world.load()
    report = world.truth_report()
    assert report["seat_depth_mm"] == pytest.approx(seat_mm - 0.4)
    assert (report["bent"], report["missing"], report["blocked"]) == (["4"], ["9"], ["2"])


def test_camera_1_sees_what_is_wrong_on_the_tray(scenario: BenchScenario) -> None:
    world = bench_at(scenario, "tray_look", 4)
    _, good = world.camera_scene("camera_1").bodies
    assert isinstance(good, ScenePlate)
    world.faults.inject("empty_tray")
    world.load()
    (tray,) = world.camera_scene("camera_1").bodies
    assert isinstance(tray, ScenePlate)
    assert tray.name == "tray"
    assert world.truth_report()["module"] == "absent"
    world.faults.clear()

    world.faults.inject("turned")
    world.load()
    _, turned = world.camera_scene("camera_1").bodies
    assert isinstance(turned, ScenePlate)
    angle = (good.camera_T_part.inv() * turned.camera_T_part).rotation.magnitude()
    assert np.rad2deg(angle) == pytest.approx(180, abs=3)
    world.faults.clear()

    world.faults.inject("upside_down")
    world.load()
    plug, _ = world.camera_scene("camera_1").bodies
    assert isinstance(plug, SceneConnector)
    assert plug.camera_T_connector.translation == pytest.approx(
        good.camera_T_part.translation, abs=3e-3
    )


def test_jaws_close_beyond_a_module_that_is_not_there(scenario: BenchScenario) -> None:
    world = bench_at(scenario, "above_tray", 3)
    world.faults.inject("empty_tray")
    world.load()
    hands = Hands(world)
    hands.true_flange_to(hands.over_module())
    hands.jaws(close=True)
    assert world.jaws["gripper"].last_position == 1.0
    assert world.truth_report()["module"] == "absent"


def test_warmth_moves_the_flange_from_the_next_motion_on(scenario: BenchScenario) -> None:
    shifts_m = []
    for seed in range(12):
        world = AntennaBench(scenario, seed)
        before = world.flange("arm").translation
        world.warm(3.0)
        shifts_m.append(float(np.linalg.norm(world.flange("arm").translation - before)))
    assert 5e-6 < np.mean(shifts_m) < 100e-6


def test_repeatability_is_that_of_the_standard(scenario: BenchScenario) -> None:
    """RP = mean distance + three of its standard deviations: 3.6 sigma of an axis."""
    arm = AntennaBench(scenario, 5).arms["arm"]
    home, places, time_s = arm.joints(0.0), [], 0.0
    for number in range(400):
        arm.start_joint(time_s, home + 0.2 * (number % 2), 100)
        time_s = arm.standstill_s + 0.1
        if number % 2:
            places.append(arm.flange(time_s).translation)
    distances = np.linalg.norm(places - np.mean(places, axis=0), axis=1)
    assert distances.mean() + 3 * distances.std() == pytest.approx(0.02e-3, rel=0.25)


def _down(way_m: float) -> RigidTransform:
    return RigidTransform.from_translation([0.0, 0.0, way_m])
