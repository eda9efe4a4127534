"""An arm that somebody jogs at its panel, and procedure 208 with it."""

from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.interfaces import RobotMode
from cellctl.processes.antenna_module.procedures import touch_tool
from cellctl.processes.antenna_module.procedures.by_hand import Patience
from cellctl.processes.antenna_module.stations import AntennaCell
from cellctl.runtime.procedure import ProcedureContext
from tests.rigs.procedure_record import Kept

POINT_M = np.array([0.55, 0.1, 0.25])
FLANGE_T_TIP = pose_from_xyzabc((2.0, -1.0, 205.0, 30.0, 0.0, 0.0))


def touching() -> list[RigidTransform]:
    """The tip on the point: tilted by 45° in four directions, at two turns 90° apart."""
    poses = []
    for turn in (0.0, 90.0):
        for direction in (0.0, 90.0, 180.0, 270.0):
            tilt = Rotation.from_euler("ZYZ", [direction, 45.0, turn - direction], degrees=True)
            rotation = tilt * Rotation.from_euler("x", 180.0, degrees=True)
            poses.append(with_tip_at(rotation, POINT_M))
    return poses


def orienting() -> list[RigidTransform]:
    """Poses at the point, 50 mm along x of the tool, and 50 mm to the side of its y."""
    rotation = Rotation.from_euler("x", 180.0, degrees=True)
    axes = (rotation * FLANGE_T_TIP.rotation).as_matrix()
    return [
        with_tip_at(rotation, POINT_M + 0.05 * step)
        for step in (np.zeros(3), axes[:, 0], axes[:, 1])
    ]


def with_tip_at(rotation: Rotation, place_m: np.ndarray) -> RigidTransform:
    return RigidTransform.from_components(
        place_m - rotation.apply(FLANGE_T_TIP.translation), rotation
    )


@dataclass
class Panel(Kept):
    """An arm that somebody jogs from pose to pose, with the key to manual and back."""

    poses: list[RigidTransform] = field(default_factory=list)
    asked: int = 0

    def state(self) -> SimpleNamespace:
        # Still on remote, then manual, then back on remote at the next place.
        phase = self.asked % 3
        self.asked += 1
        mode = RobotMode.MANUAL if phase == 1 else RobotMode.REMOTE
        pose = self.poses[min(self.asked // 3, len(self.poses)) - 1]
        return SimpleNamespace(mode=mode, ready=True, moving=False, base_T_flange=pose)

    async def progress(self, done: int, total: int, message: str) -> None:
        await super().progress(done, total, message)
        self.asked = 3 * (done - 1)


AT_ONCE = Patience(poll_s=0.0)


async def _still(_guard: object) -> None:
    return


async def in_worker(job: Any, *arguments: object) -> Any:
    return job(*arguments)


async def touched(
    panel: Panel, monkeypatch: pytest.MonkeyPatch, patience: Patience = AT_ONCE
) -> Any:
    monkeypatch.setattr(touch_tool, "settle", _still)
    arm = SimpleNamespace(robot=panel, guard=None)
    cell = SimpleNamespace(arm=arm, workers=SimpleNamespace(run=in_worker))
    return await touch_tool.touch_tool_on_cell(
        cast(AntennaCell, cell), cast(ProcedureContext, panel), patience
    )
