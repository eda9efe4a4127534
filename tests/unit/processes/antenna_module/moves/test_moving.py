"""Ways of the arm through free air."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import MM, Array, pose_from_xyzabc
from cellctl.processes.antenna_module.moves.moving import Mover
from tests.rigs.shipped import shipped_cell

CELL = shipped_cell("antenna.toml")


class Noting(Mover):
    """A mover that goes nowhere."""

    went: list[RigidTransform | Array]

    async def to(self, base_T_flange: RigidTransform) -> None:
        self.went.append(base_T_flange)

    async def to_joints(self, joints_rad: Array) -> None:
        self.went.append(joints_rad)


def standing_at(height_mm: float, config: Any = CELL) -> Noting:
    here = pose_from_xyzabc((450.0, 300.0, height_mm, 0.0, 0.0, 180.0))
    robot = SimpleNamespace(state=lambda: SimpleNamespace(base_T_flange=here))
    sensor = SimpleNamespace(mounted_on="arm")
    arm = SimpleNamespace(robot=robot, sensor=sensor, config=config.robots["arm"])
    mover = Noting(SimpleNamespace(arm=arm, cell=SimpleNamespace(config=config)))  # type: ignore[arg-type]
    object.__setattr__(mover, "went", [])
    return mover


async def test_from_below_it_goes_straight_up_first() -> None:
    """The flange is at 500 mm where the plug is shown to camera II."""
    mover = standing_at(420.0)
    await mover.to_taught_over("inspect_plug")
    up, joints_rad = mover.went
    assert isinstance(up, RigidTransform)
    assert isinstance(joints_rad, np.ndarray)
    assert up.translation / MM == pytest.approx([450.0, 300.0, 500.0], abs=0.01)
    inspect_deg = CELL.robots["arm"].poses_deg["inspect_plug"]
    assert np.degrees(joints_rad) == pytest.approx(inspect_deg)


async def test_from_above_it_goes_by_joints_alone() -> None:
    mover = standing_at(520.0)
    await mover.to_taught_over("inspect_plug")
    assert len(mover.went) == 1


async def test_an_arm_without_a_table_goes_as_it_was_taught() -> None:
    arm = CELL.robots["arm"]
    settings = {key: value for key, value in arm.settings.items() if key != "dh"}
    bare = arm.model_copy(update={"settings": settings})
    mover = standing_at(420.0, CELL.model_copy(update={"robots": {"arm": bare}}))
    await mover.to_taught_over("inspect_plug")
    assert len(mover.went) == 1
