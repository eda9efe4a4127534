"""The fake antenna cell through the real drivers: look, grip, weigh, look from below, plug."""

import asyncio
import time
import tomllib
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from cellctl.interfaces import CameraImage
from drivers.camera.frame_server.config import FrameServerConfig
from drivers.camera.frame_server.driver import FrameServerCamera
from drivers.ftsensor.sri.config import SriConfig
from drivers.ftsensor.sri.driver import SriSensor
from drivers.gripper.pneumatic.config import PneumaticGripperConfig
from drivers.gripper.pneumatic.driver import PneumaticGripper
from drivers.robot.siasun.config import SiasunConfig
from drivers.robot.siasun.driver import SiasunRobot
from fakes.world.connector.drawing import SOCKET_T_MATED_PLUG
from fakes.world.frames import from_written
from tests.rigs.whole_cell.own_cell import OwnCell

pytestmark = [pytest.mark.timeout(300), pytest.mark.long]
G_M_S2 = 9.80665
SPEED_M_S = 0.05
MODULE_KG = 0.25


@dataclass
class Bench:
    """The drivers of the shipped cell file, and the truth."""

    own: OwnCell
    robot: SiasunRobot
    gripper: PneumaticGripper
    sensor: SriSensor
    cameras: dict[str, FrameServerCamera]
    poses_deg: dict[str, list[float]]

    def truth(self) -> dict[str, Any]:
        with self.own.control() as control:
            truth: dict[str, Any] = control.request("truth")["truth"]
        return truth

    async def taught(self, name: str) -> None:
        await self.robot.move_joint(np.radians(self.poses_deg[name]), speed_ratio=0.5)

    async def true_flange_to(self, cell_T_flange: RigidTransform) -> None:
        """Move as somebody does who knows by what the arm is wrong."""
        for _ in range(2):
            here = self.robot.state().base_T_flange
            off = here * from_written(self.truth()["cell_T_flange_mm_deg"]).inv()
            await self.robot.move_linear(
                off * cell_T_flange, speed_m_s=SPEED_M_S, acceleration_m_s2=0.2
            )

    async def down(self, way_m: float) -> None:
        target = self.robot.state().base_T_flange * RigidTransform.from_translation([0, 0, way_m])
        await self.robot.step(target, speed_m_s=0.002)

    async def force_z(self) -> float:
        """Mean raw reading of the sensor's z over half a second."""
        return await asyncio.to_thread(self._read_force_z)

    def _read_force_z(self) -> float:
        # Nobody reads while the arm moves: what has piled up is of the past.
        while self.sensor.read(0.0):
            continue
        readings: list[float] = []
        deadline_s = time.monotonic() + 20.0
        while len(readings) < 500 and time.monotonic() < deadline_s:
            readings += [sample.fz_n for sample in self.sensor.read(0.2)]
        assert len(readings) >= 500
        return float(np.mean(readings))


@asynccontextmanager
async def bench(folder: Path) -> AsyncIterator[Bench]:
    own = OwnCell.make(folder, "antenna")
    try:
        own.fake(seed=3).ready()
        cell = tomllib.loads(own.cell.read_text(encoding="utf-8"))
        arm = cell["robots"]["arm"]
        cameras = {
            name: FrameServerCamera(name, FrameServerConfig.model_validate(camera["settings"]))
            for name, camera in cell["cameras"].items()
        }
        gripper = cell["grippers"]["gripper"]["settings"]
        force = cell["force_sensors"]["force"]["settings"]
        rig = Bench(
            own,
            SiasunRobot("arm", SiasunConfig.model_validate(arm["settings"])),
            PneumaticGripper("gripper", PneumaticGripperConfig.model_validate(gripper)),
            SriSensor(SriConfig.model_validate(force)),
            cameras,
            arm["poses_deg"],
        )
        devices = [rig.robot, rig.gripper, *cameras.values()]
        await asyncio.gather(*(device.connect() for device in devices))
        await asyncio.to_thread(rig.sensor.open)
        yield rig
        rig.sensor.close()
        await asyncio.gather(*(device.disconnect() for device in devices))
    finally:
        own.kill_all()


async def saturated(camera: FrameServerCamera) -> NDArray[np.bool_]:
    """Where the picture is bright enough and has a colour: the insulator and the pins."""
    # In a thread: while it computes, the robot's reports have to be read.
    return await asyncio.to_thread(_saturated, await camera.grab())


def _saturated(image: CameraImage) -> NDArray[np.bool_]:
    pixels = image.pixels.astype(float)
    most, least = pixels.max(axis=2), pixels.min(axis=2)
    return np.asarray((most > 40) & (most - least > 0.5 * most))


async def test_a_module_is_plugged_by_somebody_who_knows_the_truth(tmp_path: Path) -> None:
    async with bench(tmp_path) as cell:
        await cell.taught("tray_look")
        top = await cell.cameras["camera_1"].grab()
        assert np.std(top.pixels) > 20

        await cell.taught("above_tray")
        empty_n = await cell.force_z()
        plug = from_written(cell.truth()["cell_T_plug_mm_deg"])
        await cell.true_flange_to(plug * RigidTransform.from_translation([0, 0, -0.2]))
        await cell.gripper.close()
        assert cell.truth()["module"] == "gripper"
        await cell.taught("above_tray")
        assert await cell.force_z() - empty_n == pytest.approx(MODULE_KG * G_M_S2, abs=0.3)

        await cell.taught("inspect_plug")
        seen = await saturated(cell.cameras["camera_2"])
        rows, columns = np.nonzero(seen)
        # The insulator, 12 by 4 mm at 30 µm a pixel, near the middle of the picture.
        assert 25_000 < seen.sum() < 70_000
        assert [columns.mean(), rows.mean()] == pytest.approx([1024, 544], abs=110)

        await cell.taught("socket_look")
        seen = await saturated(cell.cameras["camera_1"])
        assert 25_000 < seen.sum() < 70_000

        await cell.taught("above_socket")
        tare_n = await cell.force_z()
        await plug_into_socket(cell)
        truth = cell.truth()
        assert set(truth["pins"].values()) == {"inside"}
        assert truth["seated_depth_mm"] > 1.5
        assert tare_n - await cell.force_z() > 3.0
        await cell.gripper.open()
        assert cell.truth()["module"] == "socket"


async def plug_into_socket(cell: Bench) -> None:
    """Go to just above the face, then by steps until the contact springs are open."""
    truth = cell.truth()
    flange = from_written(truth["cell_T_flange_mm_deg"])
    flange_T_plug = flange.inv() * from_written(truth["cell_T_plug_mm_deg"])
    above = RigidTransform.from_translation([0, 0, 0.2e-3]) * SOCKET_T_MATED_PLUG
    socket = from_written(truth["cell_T_socket_mm_deg"])
    await cell.true_flange_to(socket * above * flange_T_plug.inv())
    for _ in range(11):
        await cell.down(0.2e-3)
