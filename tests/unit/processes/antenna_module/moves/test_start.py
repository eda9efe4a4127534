"""Where a run begins: clear of the stations, and never with a module in the gripper (F583)."""

from types import SimpleNamespace
from typing import Any, cast

import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.antenna_module.faults.plugging import ModuleInGripper
from cellctl.processes.antenna_module.moves import start
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.stations import AntennaCell, antenna_recipes
from tests.rigs.shipped import shipped_cell
from tests.unit.processes.antenna_module.steps.bench import TAUGHT, Bench

OVER_TRAY = pose_from_xyzabc((450.0, 300.0, 365.0, 0.0, 0.0, 180.0))
IN_SOCKET = pose_from_xyzabc((500.0, -200.0, 398.0, 0.0, 0.0, 180.0))


def cell_of(bench: Bench, *, opened: bool, part: bool) -> AntennaCell:
    async def state() -> SimpleNamespace:
        return SimpleNamespace(opened=opened, part_present=part)

    made: Any = bench.run().cell
    made.gripper = SimpleNamespace(state=state, open=bench.open)
    made.recipes = antenna_recipes(shipped_cell("antenna.toml"))
    return cast(AntennaCell, made)


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Bench:
    made = Bench()

    async def draw_out(_cell: AntennaCell, _recipe: AntennaRecipe) -> None:
        made.events.append("draw out")

    monkeypatch.setattr(start, "Mover", lambda _cell: made)
    monkeypatch.setattr(start, "draw_out", draw_out)
    return made


@pytest.mark.parametrize("left_at", [OVER_TRAY, IN_SOCKET], ids=["tray", "socket"])
async def test_out_of_a_station_straight_up_then_home(
    bench: Bench, left_at: RigidTransform
) -> None:
    bench.base_T_flange = left_at
    await start.leave_stations(cell_of(bench, opened=True, part=False))
    assert bench.events == ["slowly", "home"]
    assert bench.heights_mm[0] > left_at.translation[2] * 1e3 + 50.0
    assert bench.visited[0].translation[:2] == pytest.approx(left_at.translation[:2])


async def test_away_from_the_stations_it_goes_home_at_once(bench: Bench) -> None:
    bench.base_T_flange = TAUGHT["inspect_plug"]
    await start.leave_stations(cell_of(bench, opened=True, part=False))
    assert bench.events == ["home"]


async def test_nothing_begins_with_a_module_in_the_gripper(bench: Bench) -> None:
    bench.base_T_flange = IN_SOCKET
    with pytest.raises(ModuleInGripper, match="closed on a part"):
        await start.leave_stations(cell_of(bench, opened=False, part=True))
    # Out of the socket with a pull that a plug may need, and never let go: opened, it would fall.
    assert bench.events == ["draw out", "slowly", "home"]
