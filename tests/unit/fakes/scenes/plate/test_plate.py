"""The simplest scene: a single camera sees the plate where it lies, a sensor feels its payload."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

from fakes.render import api
from fakes.render.look import options_of
from fakes.render.optics.lens import views_of
from fakes.render.optics.surface import to_pixels
from fakes.render.worker import render_frame
from fakes.scenario_file.sections import Spread
from fakes.scenes.plate.scenario import PlateScenario, PrintedBoard
from fakes.scenes.plate.scene import PlateScene
from fakes.world.arm import inverse
from fakes.world.frames import from_written
from fakes.world.scene import MonoTruth, SceneChessboard, ScenePlate

CONFIG = Path(__file__).parents[5] / "config"


@pytest.fixture(scope="module")
def scenario() -> PlateScenario:
    return PlateScenario.read(CONFIG / "small.scenario.toml")


def at(world: PlateScene, pose: str) -> PlateScene:
    arm = world.arms["arm"]
    target = from_written(world.scenario.taught["arm"][pose])
    joints = inverse(arm.settings.chain_mm, target, arm.joints(world.time_s))
    arm.start_joint(world.time_s, joints, 100)
    world.advance(arm.standstill_s + 1.5)
    return world


def test_the_taught_poses_of_the_cell_file_are_those_of_the_scenario(
    scenario: PlateScenario,
) -> None:
    cell = tomllib.loads((CONFIG / "small.toml").read_text())
    for pose in ("look", "weigh"):
        arm = at(PlateScene(scenario, 1), pose).arms["arm"]
        taught = cell["robots"]["arm"]["poses_deg"][pose]
        np.testing.assert_allclose(np.rad2deg(arm.joints(100.0)), taught, atol=1e-5)


def test_the_camera_sees_the_holes_where_they_are(scenario: PlateScenario) -> None:
    world = at(PlateScene(scenario, 2), "look")
    scene = world.camera_scene("camera")
    (plate,) = scene.bodies
    assert isinstance(plate, ScenePlate)
    assert isinstance(scene.optics, MonoTruth)
    assert scenario.rendering is not None
    frame = render_frame(scene, options_of(scenario.rendering))
    image = np.frombuffer(frame.payload, np.uint8).reshape(frame.height, frame.width)
    (view,) = views_of(scene.optics)
    centres = np.array([[*hole.position_m, 0.0] for hole in plate.holes])
    pixels = np.rint(to_pixels(view, plate.camera_T_part, centres)).astype(int)
    assert len(pixels) == 4
    for x, y in pixels:
        assert image[y, x] < 40
        assert image[y, x + 40] > 100


def test_truth_and_picture_agree_on_the_holes(scenario: PlateScenario) -> None:
    world = at(PlateScene(scenario, 3), "look")
    (plate,) = world.camera_scene("camera").bodies
    assert isinstance(plate, ScenePlate)
    report = world.report()
    cell_T_camera = from_written(report["cell_T_camera_mm_deg"]["camera"])
    clean = api.RenderOptions.clean()
    for name, place in api.hole_centres_m(plate, clean).items():
        expected = report["plates"]["plate"]["holes_mm"][name]
        np.testing.assert_allclose(cell_T_camera.apply(place) * 1000, expected, atol=1e-6)


def test_a_colour_camera_has_three_channels(scenario: PlateScenario) -> None:
    camera = scenario.cameras["camera"].model_copy(update={"colour": True})
    optics = scenario.optics["small"].model_copy(
        update={"image_px": (80, 60), "centre_px": (40.0, 30.0)}
    )
    coloured = scenario.model_copy(
        update={"cameras": {"camera": camera}, "optics": {"small": optics}}
    )
    scene = at(PlateScene(coloured, 1), "look").camera_scene("camera")
    assert coloured.rendering is not None
    frame = render_frame(scene, options_of(coloured.rendering))
    pixels = np.frombuffer(frame.payload, np.uint8).reshape(60, 80, 3).astype(float)
    red, green, blue = pixels.mean(axis=(0, 1))
    assert red > green > blue > 100


def test_the_sensor_feels_the_weight_of_its_payload(scenario: PlateScenario) -> None:
    world = at(PlateScene(scenario, 1), "look")
    weight_n = 9.80665 * scenario.payloads["force"].mass_kg
    load = np.array(world.report()["load_n_nm"]["force"])
    assert np.linalg.norm(load[:3]) == pytest.approx(weight_n, rel=1e-6)
    sensor = world.truth.force_sensors["force"]
    rows = [world.sensor_wrench("force", world.time_s + 1e-3 * k) for k in range(500)]
    reading = np.mean(rows, axis=0) - sensor.offset
    assert np.linalg.norm(reading[:3]) == pytest.approx(weight_n, rel=0.03)


def test_a_sensor_without_a_payload_carries_nothing(scenario: PlateScenario) -> None:
    world = PlateScene(scenario.model_copy(update={"payloads": {}}), 1)
    world.advance(1.0)
    reading = world.sensor_wrench("force", 1.0) - world.truth.force_sensors["force"].offset
    assert np.linalg.norm(reading[:3]) < 2.0


def test_every_load_lies_elsewhere_within_its_spread(scenario: PlateScenario) -> None:
    world = PlateScene(scenario, 1)
    nominal = np.array(scenario.plates["plate"].cell_T_plate_mm_deg[:3])
    places = []
    for _ in range(20):
        world.commands()["load"]()
        places.append(world.plates["plate"].cell_T_body.translation * 1000)
    assert len({tuple(place) for place in places}) == 20
    assert (np.abs(places - nominal) <= [3.0, 3.0, 1.0]).all()
    assert world.report()["load"] == 21


def test_a_board_is_seen_too(scenario: PlateScenario) -> None:
    board = PrintedBoard(
        inner_corners=(9, 6),
        square_mm=10.0,
        size_mm=(120.0, 90.0),
        cell_T_board_mm_deg=(1400.0, 0.0, 400.0, 0.0, 0.0, 0.0),
        placement=Spread(xyz_mm=(1.0, 1.0, 1.0), rotation_deg=(0.1, 0.1, 0.1)),
    )
    world = PlateScene(scenario.model_copy(update={"plates": {}, "boards": {"board": board}}), 1)
    (seen,) = at(world, "look").camera_scene("camera").bodies
    assert isinstance(seen, SceneChessboard)
    assert seen.camera_T_board.translation[2] == pytest.approx(0.5, abs=0.01)


def test_a_payload_hangs_behind_a_sensor_that_there_is(scenario: PlateScenario) -> None:
    values = scenario.model_dump(exclude_none=True)
    values["payloads"]["scales"] = values["payloads"]["force"]
    with pytest.raises(ValueError, match="no force sensors scales"):
        PlateScenario.model_validate(values)
