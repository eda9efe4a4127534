"""Somebody at the panel plugs the held module until it sits free of side forces."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from fakes.faults import ROBOT_FAULTS, FaultBoard
from fakes.scenes.antenna_bench.hands import seated_by_hand
from fakes.scenes.antenna_bench.scenario import BenchScenario
from fakes.scenes.antenna_bench.scene import AntennaBench
from fakes.scenes.antenna_bench.standing_by import StandingBy
from fakes.wire.sjl.logic import Controller
from fakes.world.connector.drawing import SOCKET_T_MATED_PLUG
from fakes.world.frames import MM
from tests.unit.fakes.scenes.antenna_bench.placed_arm import bench_at


def holding(scenario: BenchScenario, seed: int, pose: str = "above_socket") -> AntennaBench:
    """Quick hands with the module in the fingers, because the test pays for each millisecond."""
    hands = scenario.hands.model_copy(update={"travel_mm_s": 200.0, "plugging_mm_s": 20.0})
    world = bench_at(scenario, pose, seed, hands=hands)
    world.module.place = "gripper"
    jaws = world.jaws["gripper"]
    jaws.part_present = True
    jaws.drive(0.0, open_coil=False, close_coil=True)
    jaws.position(1.0)
    return world


def wait_for_the_key(world: AntennaBench) -> None:
    for _ in range(40):
        world.advance(world.time_s + 0.05)
        if not world.arms["arm"].by_hand:
            return
    raise AssertionError("the key was never turned back")


def test_a_plug_that_was_plugged_by_hand_sits_without_side_force(scenario: BenchScenario) -> None:
    world = holding(scenario, 3)
    panel = Controller(world.arms["arm"], FaultBoard("arm", ROBOT_FAULTS))
    assert panel.panel.mode == "REM"
    world.operator.plug_by_hand()
    assert panel.panel.mode == "MAN"
    with pytest.raises(ValueError, match="moving arm"):
        world.operator.plug_by_hand()
    wait_for_the_key(world)
    assert panel.panel.mode == "REM"
    assert not panel.moving(world.time_s)
    report = world.truth_report()
    assert set(report["pins"].values()) == {"inside"}
    assert report["seated_depth_mm"] == pytest.approx(report["seat_depth_mm"], abs=0.02)
    assert report["offset_at_worst_contact_mm"] < 0.05
    assert max(report["peak_side_n"].values()) < 0.5
    response = world.mating.response
    assert response is not None
    assert np.abs(response.wrench[:2]).max() < 0.5


def test_the_flange_ends_where_the_hand_has_felt_the_seat(scenario: BenchScenario) -> None:
    """Whatever the arm is wrong by: the encoders show by what."""
    world = holding(scenario, 5)
    felt = scenario.hands.model_copy(update={"gauge_sigma_mm": 0.0, "gauge_sigma_deg": 0.0})
    rng = np.random.default_rng(0)
    seat = world.parts.cell_T_socket * seated_by_hand(world.parts.pair, world.mount, felt, rng)
    target = seat * world.module.flange_T_plug.inv()
    world.arms["arm"].start_jog(0.0, target, 0.5)
    world.advance(world.arms["arm"].standstill_s + 0.01)
    left = target.inv() * world.flange("arm")
    assert np.linalg.norm(left.translation) < 1e-9
    shown = world.arms["arm"].encoder_pose(world.time_s)
    assert 0.05e-3 < np.linalg.norm(shown.translation - target.translation) < 1.5e-3


def test_what_a_hand_does_not_feel_is_as_large_as_the_play_of_the_gauge(
    scenario: BenchScenario,
) -> None:
    world = AntennaBench(scenario, 1)
    rng = np.random.default_rng(7)
    pair, mount = world.parts.pair, world.mount
    seats = [seated_by_hand(pair, mount, scenario.hands, rng) for _ in range(120)]
    places = np.array([seat.translation for seat in seats])
    sigma_mm = scenario.hands.gauge_sigma_mm
    assert places.std(axis=0) / MM == pytest.approx([sigma_mm] * 3, rel=0.25)
    # The middle of all: the pins on their holes as well as both patterns allow.
    middle = RigidTransform.from_translation(places.mean(axis=0)) * SOCKET_T_MATED_PLUG
    off = pair.pins_m - pair.holes_m + (middle * SOCKET_T_MATED_PLUG.inv()).translation[:2]
    assert np.abs(off.mean(axis=0)).max() < 1.5e-6


def test_nobody_plugs_what_is_not_held_or_far_away(scenario: BenchScenario) -> None:
    with pytest.raises(ValueError, match="no module"):
        bench_at(scenario, "above_socket").operator.plug_by_hand()
    far = holding(scenario, 1, "inspect_plug")
    with pytest.raises(ValueError, match="from its socket"):
        far.operator.plug_by_hand()
    assert not far.arms["arm"].by_hand


def test_an_operator_who_stands_by_plugs_what_waits_and_brings_the_next(
    scenario: BenchScenario,
) -> None:
    world = holding(scenario, 6)
    world.advance(2.0)
    assert not world.arms["arm"].by_hand, "nobody stands by"
    world.operator.stand_by()
    world.advance(world.time_s + scenario.hands.patience_s + 0.3)
    assert world.arms["arm"].by_hand
    world.module.place = "socket"
    assert world.loads == 1, "the arm is still there"


@pytest.mark.parametrize(("on", "expected"), [(True, "load"), (False, None)])
def test_the_next_module_comes_when_the_arm_has_gone(*, on: bool, expected: str | None) -> None:
    operator = StandingBy(patience_s=1.0, on=on)
    assert operator.errand(0.0, waits_above=False, left_in_socket=True) == expected


def test_a_plug_that_comes_and_goes_does_not_wait() -> None:
    operator = StandingBy(patience_s=1.0, on=True)
    for time_s, waits in ((0.0, True), (0.9, True), (1.0, False), (1.1, True), (2.0, True)):
        assert operator.errand(time_s, waits_above=waits, left_in_socket=False) is None
    assert operator.errand(2.2, waits_above=True, left_in_socket=False) == "plug"
    assert operator.errand(2.3, waits_above=True, left_in_socket=False) is None
