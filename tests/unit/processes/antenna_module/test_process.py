"""Reset clears each arm of the process once, also beside one whose gripper holds a module."""

from types import SimpleNamespace
from typing import Any

import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.processes.antenna_module.faults.plugging import ModuleInGripper
from cellctl.processes.antenna_module.moves import start
from cellctl.processes.antenna_module.process import AntennaModule
from cellctl.processes.antenna_module.stations import AntennaCell, antenna_recipes
from tests.rigs.shipped import shipped_cell

CELL = shipped_cell("antenna.toml")


async def test_each_arm_leaves_its_stations_though_one_holds_a_module(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    (recipe,) = antenna_recipes(CELL)
    other = recipe.model_copy(update={"id": 2, "roles": recipe.roles | {"force": "other_force"}})
    config = SimpleNamespace(recipes=(recipe, other))
    left: dict[str, list[int]] = {}

    def cell(_: AntennaModule, of: Any) -> AntennaCell:
        arm: Any = SimpleNamespace(sensor_name=of.device("force"))
        made: Any = SimpleNamespace(config=config)
        none: Any = None
        return AntennaCell(made, arm, none, none, none, none, RigidTransform.identity())

    async def leave(cell: AntennaCell) -> None:
        left[cell.arm.sensor_name] = [one.id for one in cell.recipes]
        if len(left) == 1:
            raise ModuleInGripper("the gripper is closed on a part")

    monkeypatch.setattr(start, "leave_stations", leave)
    monkeypatch.setattr(AntennaModule, "cell", cell)
    services: Any = SimpleNamespace(cell=SimpleNamespace(config=config))
    with pytest.raises(ModuleInGripper):
        await AntennaModule(services).clear()
    assert left == {"force": [1], "other_force": [2]}
