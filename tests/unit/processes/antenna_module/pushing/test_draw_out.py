"""Out of the socket at a Reset: slowly, with a pull that a plug may need, from any press."""

from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.errors.force import LiftOffHeld
from cellctl.errors.robot import MotionRejected
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.guard.limits import GuardLimits
from cellctl.guard.report import GuardSamples, GuardTrip, TareResult, TripReason
from cellctl.processes.antenna_module.insertion.limits import InsertionLimits
from cellctl.processes.antenna_module.looking import nominal
from cellctl.processes.antenna_module.mated import MATED_TURN
from cellctl.processes.antenna_module.pushing.back_out import PULL_RATIO, SPEED_M_S
from cellctl.processes.antenna_module.pushing.draw_out import draw_out
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.stations import AntennaCell, antenna_recipes
from tests.rigs.shipped import shipped_cell
from tests.unit.cell.guard import TinyGuard
from tests.unit.cell.robots import StillRobot
from tests.unit.processes.antenna_module.pushing.contact import SOCKET
from tests.unit.processes.antenna_module.steps.bench import CONFIG

CELL = shipped_cell("antenna.toml")
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
class WithZero(TinyGuard):
    """A true force along z, told from the zero that was taken last; the run's hides nothing."""

    true_n: float = SEAT_PRESS_N
    zero_n: float = 0.0

    def samples(self, since_s: float) -> GuardSamples:
        told_n = np.array([0.0, 0.0, self.true_n - self.zero_n, 0.0, 0.0, 0.0])
        samples = super().samples(since_s)
        noise = samples.wrench * 0.05
        # A sensor reads its load as well, and in its own axes.
        frame = pose_from_xyzabc(recipe().flange_T_plug) * MATED_TURN
        force_n = frame.rotation.apply([0.0, 0.0, self.true_n]) + np.array([1.0, 2.0, -15.0])
        raw = noise + np.concatenate([force_n, np.zeros(3)])
        return replace(samples, wrench=noise + told_n, raw=raw)

    async def tare(self, duration_s: float, *, hides_axial_n: float = 0.0) -> TareResult:
        self.zero_n = self.true_n
        return await super().tare(duration_s, hides_axial_n=hides_axial_n)


@dataclass
class Left:
    """An arm that a Stop has left somewhere."""

    flange: RigidTransform
    restarted: bool = False
    guard: WithZero = field(default_factory=WithZero)
    zero_file: Path | None = None

    def __post_init__(self) -> None:
        self.robot = StillRobot("arm", flange=self.flange, watched_by=self.guard)
        self.guard.gravity_compensated = False
        self.guard.in_part_frame = not self.restarted

    async def drawn(self) -> None:
        arm = SimpleNamespace(
            robot=self.robot, guard=self.guard, sensor_name="force",
            sensor=CELL.force_sensors["force"], flange_T_sensor=RigidTransform.identity(),
            zero_file=self.zero_file,
        )  # fmt: skip
        cell: Any = SimpleNamespace(
            config=CELL, folder=CONFIG, trips_awaited=lambda _: nullcontext()
        )
        await draw_out(cast(AntennaCell, SimpleNamespace(cell=cell, arm=arm)), recipe())

    @property
    def limits(self) -> GuardLimits:
        return self.guard.limits[-1]

    async def stopped_on_the_way(self, true_n: float) -> None:
        """A Reset that somebody stops, with this force on the plug then."""
        self.robot.faults["move"] = MotionRejected("stopped")
        with pytest.raises(MotionRejected):
            await self.drawn()
        del self.robot.faults["move"]
        self.guard.true_n = true_n


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


@pytest.mark.parametrize("stops", [1, 2])
@pytest.mark.parametrize("left_n", [SEAT_PRESS_N, 12.0, 0.0])
async def test_what_presses_after_a_reset_that_was_stopped_is_no_pull(
    left_n: float, stops: int
) -> None:
    left = Left(flange_at(2.5))
    for _ in range(stops):
        await left.stopped_on_the_way(left_n)
    await left.drawn()
    assert left.limits.filtered[2] == pytest.approx(MAY_NEED_N + left_n, abs=0.5)


async def test_a_press_that_nobody_knew_is_known_no_better_after_a_reset_that_was_stopped() -> None:
    left = Left(flange_at(2.5), restarted=True)
    await left.stopped_on_the_way(SEAT_PRESS_N - 7.0)
    await left.drawn()
    unknown_n = LIMITS.at(LIMITS.seat_depth_m).axial_n
    assert left.limits.filtered[2] == pytest.approx(MAY_NEED_N + unknown_n - 7.0, abs=0.5)


async def test_a_plug_that_was_left_pulled_is_pulled_no_harder_by_the_next_reset() -> None:
    left = Left(flange_at(2.5))
    await left.stopped_on_the_way(-30.0)
    await left.drawn()
    assert left.limits.filtered[2] == pytest.approx(MAY_NEED_N - 30.0, abs=0.5)


async def test_a_plug_that_holds_a_full_pull_is_not_pulled_again() -> None:
    left = Left(flange_at(2.5))
    await left.stopped_on_the_way(-MAY_NEED_N - 2.0)
    armed = len(left.guard.limits)
    with pytest.raises(LiftOffHeld, match=r"pulled with 7\d N already"):
        await left.drawn()
    assert len(left.guard.limits) == armed
    assert left.robot.moves == []


async def test_a_restart_does_not_forget_how_hard_the_plug_is_pulled(tmp_path: Path) -> None:
    held = Left(flange_at(2.5), zero_file=tmp_path / "force.json")
    held.guard.trip = GuardTrip(TripReason.FILTERED_LIMIT, 1.0, "Fz -99.0 N", 2, -99.0)
    with pytest.raises(LiftOffHeld):
        await held.drawn()
    pull_n = MAY_NEED_N + 2.0
    for restarts in range(1, 3):
        left = Left(flange_at(2.5), restarted=True, zero_file=held.zero_file)
        left.guard.true_n = -pull_n
        with pytest.raises(LiftOffHeld, match=rf"pulled with {pull_n:.0f} N already"):
            await left.drawn()
        assert left.robot.moves == [], f"restart {restarts}"
    # Somebody has freed it half, in the next one wholly.
    for left_n in (-30.0, 0.0):
        left = Left(flange_at(2.5), restarted=True, zero_file=held.zero_file)
        left.guard.true_n = left_n
        await left.stopped_on_the_way(left_n)
        assert left.limits.filtered[2] == pytest.approx(MAY_NEED_N + left_n, abs=0.5)


@pytest.mark.parametrize(("depth_mm", "pressed_n"), [(0.2, 13.0), (0.9, 51.7), (2.5, 51.7)])
async def test_after_a_restart_a_plug_counts_as_pressed_by_what_its_depth_allows(
    depth_mm: float, pressed_n: float
) -> None:
    left = Left(flange_at(depth_mm), restarted=True)
    await left.drawn()
    assert left.limits.filtered[2] == pytest.approx(MAY_NEED_N + pressed_n, abs=0.5)


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
