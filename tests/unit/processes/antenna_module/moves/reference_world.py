"""A cell whose gripper marks and plate are seen without errors, and the drive past them."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import MM, Array, pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.antenna_module.chain.cell_figures import PlugCell
from cellctl.processes.antenna_module.connector.marks import Marks
from cellctl.processes.antenna_module.drawings import Plate
from cellctl.processes.antenna_module.facts import PluggingFacts
from cellctl.processes.antenna_module.faults.connector import MarksMissing
from cellctl.processes.antenna_module.looking import Eyes, Seen
from cellctl.processes.antenna_module.moves.reference_drive import ReferenceDrive
from cellctl.processes.antenna_module.recipe import Place
from cellctl.processes.antenna_module.vision.measurement import MeasuredMarks
from cellctl.vision.camera.single_camera import SingleCamera
from cellctl.vision.camera.stereo_head import CameraModel
from tests.rigs.antenna.exact_cell import FLANGE_T_CAM1, SEEN, cell

INSPECT = pose_from_xyzabc([500.0, 100.0, 500.0, 12.0, 0.0, 180.0])
OVER_PLATE = pose_from_xyzabc([390.0, 113.0, 505.0, 12.0, 0.0, 180.0])
MARKS_MM = (0.3, -0.2, 200.0, 0.0, 0.0, 0.0)
BASE_T_PLATE = pose_from_xyzabc([500.4, 112.2, 290.0, 1.0, 0.0, 0.0])
FROM_BELOW = RigidTransform.from_rotation(Rotation.from_euler("x", 180, degrees=True))
A6_DEG = -168.0


def marks(name: str) -> Marks:
    corners_m = np.array([[0.0, 0.0], [0.01, 0.0], [0.0, 0.02]])
    drawn = RigidTransform.identity()
    return Marks(name, True, ("A", "B", "C"), corners_m, 1e-3, 0.0, drawn, 1e-3, 0.01, "")


@dataclass
class World:
    """An arm without errors, seen by cameras without errors."""

    base_T_flange: RigidTransform = INSPECT
    visited: list[str | float] = field(default_factory=list)
    """Taught poses by name, turns of the last joint in degrees."""
    hidden: str = ""
    """Name of a drawing that no camera finds."""
    looks: list[tuple[str, RigidTransform]] = field(default_factory=list)
    """Names of looks, and where the marks were in the camera."""

    async def to_taught(self, pose: str) -> None:
        self.visited.append(pose)
        self.base_T_flange = OVER_PLATE

    async def to_joints(self, joints_rad: Array) -> None:
        a6_deg = float(np.degrees(joints_rad[5]))
        self.visited.append(a6_deg)
        turn = Rotation.from_euler("z", a6_deg - A6_DEG, degrees=True)
        self.base_T_flange = INSPECT * RigidTransform.from_rotation(turn)

    def state(self) -> SimpleNamespace:
        return SimpleNamespace(base_T_flange=self.base_T_flange)

    async def look(
        self, name: str, camera: str, measure: Callable[[Any], Any]
    ) -> Seen[MeasuredMarks]:
        """What the camera would show of the drawing that is asked for."""
        assert isinstance(measure, partial)
        asked: Marks = measure.keywords["marks"]
        if asked.name == self.hidden:
            raise MarksMissing("2 spots, 4 marks needed")
        camera_T_base = self.base_T_camera(camera).inv()
        lies = camera_T_base * self.base_T_marks(asked.name)
        # The plane that is measured in faces the camera and is near where the marks are.
        expected: RigidTransform = measure.keywords["calibration"].camera_T_plane
        off = expected.inv() * lies
        assert np.abs(off.translation).max() < 1.0 * MM
        assert off.rotation.as_matrix()[2, 2] > 0.99
        assert lies.rotation.as_matrix()[2, 2] < 0
        found = MeasuredMarks(UncertainPose(lies, SEEN), np.zeros((5, 2)), 10.0, 1.0)
        self.looks.append((name, lies))
        return Seen((found,), (), self.base_T_flange, np.zeros(6), 0.0, name)

    def base_T_camera(self, camera: str) -> RigidTransform:
        return BASE_T_CAM2_UP if camera == "camera 2" else self.base_T_flange * FLANGE_T_CAM1

    def base_T_marks(self, name: str) -> RigidTransform:
        if name == "gripper":
            return self.base_T_flange * pose_from_xyzabc(MARKS_MM)
        return BASE_T_PLATE if name == "above" else BASE_T_PLATE * FROM_BELOW


BASE_T_CAM2_UP = pose_from_xyzabc([500.0, 100.0, 50.0, 3.0, 0.2, -0.1])


def drive(world: World, told: list[tuple[int, int]]) -> ReferenceDrive:
    plug_cell: PlugCell = cell()
    camera = SingleCamera((6, 4), CameraModel(np.eye(3), np.zeros(5)))
    cam2 = replace(plug_cell.cam2, pose=UncertainPose(BASE_T_CAM2_UP, SEEN))
    arm = SimpleNamespace(
        robot=world, config=SimpleNamespace(poses_deg={"inspect_plug": (0.0,) * 5 + (A6_DEG,)})
    )
    facts = SimpleNamespace(
        cell=SimpleNamespace(arm=arm, camera_1="camera 1", camera_2="camera 2"),
        camera_1=camera,
        camera_2=camera,
        plug_cell=replace(plug_cell, cam2=cam2),
        recipe=SimpleNamespace(
            flange_T_plug=(0.0, 0.0, 200.0, 0.0, 0.0, 0.0), plug_height_sigma_mm=0.05
        ),
        drawings=SimpleNamespace(gripper=marks("gripper")),
    )
    place = Place(pose=(500.0, 112.5, 290.0, 0.0, 0.0, 0.0))
    plate = Plate(marks("above"), marks("below"), place)

    async def tell(number: int, total: int) -> None:
        told.append((number, total))

    return ReferenceDrive(cast(PluggingFacts, facts), plate, cast(Eyes, world), tell)
