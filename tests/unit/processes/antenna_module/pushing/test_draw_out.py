"""Out of the socket at a Reset: slowly, with a pull that a plug may need, from any press."""

from contextlib import nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.config.load import load_cell
from cellctl.errors.force import LiftOffHeld
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.guard.limits import GuardLimits
from cellctl.guard.report import GuardTrip, TripReason
from cellctl.processes.antenna_module.insertion.limits import InsertionLimits
from cellctl.processes.antenna_module.looking import nominal
from cellctl.processes.antenna_module.mated import MATED_TURN
from cellctl.processes.antenna_module.pushing.back_out import PULL_RATIO, SPEED_M_S
from cellctl.processes.antenna_module.pushing.draw_out import draw_out
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.stations import AntennaCell, antenna_recipes
from tests.unit.cell.guard import TinyGuard
from tests.unit.cell.robots import StillRobot
from tests.unit.processes.antenna_module.pushing.contact import SOCKET
from tests.unit.processes.antenna_module.steps.bench import CONFIG

CELL = load_cell(CONFIG / "antenna.toml")
LIMITS = InsertionLimits.of(SOCKET)
MAY_NEED_N = PULL_RATIO * LIMITS.greatest_n
SEAT_PRESS_N = 27.0


def recipe() -> AntennaRecipe:
    (found,) = antenna_recipes(CELL)
    return found


def flange_at(depth_mm: float, x_mm: float = 0.0) -> RigidTransform:
    """The flange with the plug so deep in the stated socket."""
    place = RigidTransform.from_translation(np.array([x_mm, 0.0, -depth_mm]) * 1e-3)
    flange_T_plug = pose_from_xyzabc(recipe().flange_T_plug)
    return nominal(recipe().base_T_socket) * place * MATED_TURN * flange_T_plug.inv()


@dataclass
class WithSamples(TinyGuard):
    """The press of the seat along z, by the zero that the run has taken."""

    def __post_init__(self) -> None:
        self.raw = self.raw * 0.05 + np.array([0.0, 0.0, SEAT_PRESS_N, 0.0, 0.0, 0.0])


@dataclass
class Left:
    """An arm that a Stop has left somewhere."""

    flange: RigidTransform
    restarted: bool = False
    guard: WithSamples = field(default_factory=WithSamples)

    def __post_init__(self) -> None:
        self.robot = StillRobot("arm", flange=self.flange, watched_by=self.guard)
        self.guard.gravity_compensated = False
        self.guard.in_part_frame = not self.restarted

    async def drawn(self) -> None:
        arm = SimpleNamespace(
            robot=self.robot, guard=self.guard, sensor_name="force",
            sensor=CELL.force_sensors["force"], flange_T_sensor=RigidTransform.identity(),
        )  # fmt: skip
        cell: Any = SimpleNamespace(
            config=CELL, folder=CONFIG, trips_awaited=lambda _: nullcontext()
        )
        await draw_out(cast(AntennaCell, SimpleNamespace(cell=cell, arm=arm)), recipe())

    @property
    def limits(self) -> GuardLimits:
        (only,) = self.guard.limits
        return only


async def test_the_plug_is_drawn_slowly_along_its_axis_to_the_stand_off() -> None:
    left = Left(flange_at(2.5))
    await left.drawn()
    (move,) = left.robot.moves
    assert (move.kind, move.speed) == ("linear", SPEED_M_S)
    risen_m = move.target.translation - flange_at(2.5).translation
    assert risen_m[2] > 5.5e-3
    np.testing.assert_allclose(risen_m[:2], 0.0, atol=1e-9)


@pytest.mark.parametrize("restarted", [False, True])
async def test_the_pull_that_contacts_may_need_is_no_fault_from_any_press(restarted: bool) -> None:
    left = Left(flange_at(2.5), restarted=restarted)
    await left.drawn()
    _, _, axial_n, *_ = left.limits.filtered
    # First the press goes, which changes the force as well.
    assert axial_n >= MAY_NEED_N + SEAT_PRESS_N - 0.1
    if not restarted:
        assert axial_n == pytest.approx(MAY_NEED_N + SEAT_PRESS_N, abs=0.5)
    side_n = left.limits.filtered[0]
    assert side_n < 15.0


async def test_a_plug_that_is_held_is_told_as_one() -> None:
    left = Left(flange_at(2.5))
    left.guard.trip = GuardTrip(TripReason.FILTERED_LIMIT, 1.0, "Fz -99.0 N", 2, -99.0)
    with pytest.raises(LiftOffHeld, match=r"socket: .*-99\.0 N"):
        await left.drawn()


@pytest.mark.parametrize(
    "flange", [flange_at(-6.0), flange_at(2.5, x_mm=20.0)], ids=["over it", "beside it"]
)
async def test_away_from_the_socket_nothing_is_moved(flange: RigidTransform) -> None:
    left = Left(flange)
    await left.drawn()
    assert left.robot.moves == []
    assert left.guard.asked == []


def test_the_socket_of_the_recipe_is_the_one_of_these_tests() -> None:
    assert Path(recipe().socket).stem == "micro-d-15-holes"
