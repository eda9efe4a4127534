"""Camera II sees the gripper's marks at every turn of a reference check, clear of the plate."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.processes.antenna_module.chain.reference.reference_looks import turn_angles
from fakes.render.optics.lens import views_of
from fakes.render.optics.surface import to_pixels
from fakes.scenes.antenna_bench.scenario import BenchScenario
from fakes.scenes.antenna_bench.scene import AntennaBench
from fakes.world.connector.scene import SceneMarks
from fakes.world.frames import from_written, to_written
from tests.unit.fakes.scenes.antenna_bench.placed_arm import bench_with

_M_PER_PX = 29e-6
"""A little less than 30 µm, so that discs come out larger."""


def discs_px(world: AntennaBench, name: str) -> tuple[NDArray[np.float64], float]:
    """Centres, shape (n, 2), and radius of the discs of one drawing in camera II."""
    (body,) = (
        body
        for body in world.camera_scene("camera_2").bodies
        if isinstance(body, SceneMarks) and body.name == name
    )
    places = np.array([[*mark.position_m, 0.0] for mark in body.marks])
    (view,) = views_of(world.truth.cameras["camera_2"].optics)
    radius_px = body.marks[0].diameter_m / 2 / _M_PER_PX
    return np.asarray(to_pixels(view, body.camera_T_marks, places)), radius_px


@pytest.mark.parametrize("hardware_seed", range(1, 9))
def test_marks_turned_for_the_reference_stay_clear_of_the_plate(
    scenario: BenchScenario, hardware_seed: int
) -> None:
    size = np.array(scenario.optics["connector"].image_px)
    taught = from_written(scenario.taught["arm"]["inspect_plug"])
    for angle_rad in turn_angles(4):
        turn = RigidTransform.from_rotation(Rotation.from_euler("z", angle_rad))
        flange = tuple(to_written(taught * turn))
        world = bench_with(scenario, flange, hardware_seed=hardware_seed)
        marks, mark_px = discs_px(world, "gripper")
        dots, dot_px = discs_px(world, "reference plate")
        assert (marks > mark_px).all()
        assert (marks < size - mark_px).all()
        apart = np.linalg.norm(marks[:, None] - dots[None], axis=2)
        assert (apart > mark_px + dot_px + 10).all(), np.degrees(angle_rad)
