"""Steps 20 to 70 one after the other: the module found, picked, looked at, and over its socket."""

import importlib
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.cell.guarded_motion.kept_zero import Pressed, kept_zero
from cellctl.errors.force import TareImplausible
from cellctl.errors.gripper import PartLost
from cellctl.geometry.pose import MM, pose_error
from cellctl.processes.antenna_module.faults.connector import ConnectorTurned, MarksMissing
from cellctl.processes.antenna_module.faults.plugging import (
    ModuleMisplaced,
    ModuleMissing,
    PlanFarFromDrawing,
    PlugUncertain,
    WrongModuleMass,
)
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.state import GripperEmpty, Picked, Planned
from tests.unit.processes.antenna_module.steps.bench import Bench, chain_plug, nothing_swings

# Modules are named by text, because the package offers the functions under the same names.
STEPS = "cellctl.processes.antenna_module.steps"
find, pick, inspect, locate, plan, over = (
    importlib.import_module(f"{STEPS}.{name}")
    for name in (
        "find_module", "pick", "inspect_plug", "locate_socket", "plan", "stand_off",
    )
)  # fmt: skip


@pytest.fixture(autouse=True)
def _at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    nothing_swings(monkeypatch)


async def picked(bench: Bench, **changes: object) -> Picked:
    found = await find.find_module(GripperEmpty(bench.run(**changes)))
    held: Picked = await pick.pick(found)
    return held


async def planned(bench: Bench, **changes: object) -> Planned:
    seen = await inspect.inspect_plug(await picked(bench, **changes))
    done: Planned = await plan.plan(await locate.locate_socket(seen))
    return done


async def test_the_module_is_looked_at_again_from_over_it(bench: Bench) -> None:
    found = await find.find_module(GripperEmpty(bench.run()))
    assert bench.events == ["tray_look", "look tray-1", "move", "look tray-2"]
    off_m, _ = pose_error(bench.base_T_connector, found.base_T_connector)
    # One image does not measure the height: it is the drawing's, 0.03 mm off here.
    np.testing.assert_allclose(off_m[:2], 0.0, atol=1e-6)
    assert abs(off_m[2]) == pytest.approx(0.03 * MM, abs=1e-6)
    top = bench.base_T_connector * bench.connector_T_top
    assert found.top_height_m == pytest.approx(top.translation[2], abs=1e-9)


@pytest.mark.parametrize(
    ("shown", "raised"), [(MarksMissing, ModuleMissing), (ConnectorTurned, ModuleMisplaced)]
)
async def test_a_tray_without_a_good_module_is_told(
    bench: Bench, shown: type[Exception], raised: type[Exception]
) -> None:
    bench.spoilt = {"tray-1": [shown("0 spots")]}
    with pytest.raises(raised, match="0 spots"):
        await find.find_module(GripperEmpty(bench.run()))


async def test_a_module_out_of_its_pocket_is_refused(bench: Bench) -> None:
    bench.base_T_connector = (
        RigidTransform.from_translation([0.0, 2.5 * MM, 0.0]) * bench.base_T_connector
    )
    with pytest.raises(ModuleMisplaced, match=r"2\.\d+ mm .* permitted are 2 mm"):
        await find.find_module(GripperEmpty(bench.run()))


async def test_it_is_gripped_straight_from_above_and_weighed(bench: Bench) -> None:
    held = await picked(bench)
    after = bench.events[bench.events.index("look tray-2") + 1 :]
    assert after == ["move", "slowly", "close", "slowly", "part?"]
    above, grip, up = bench.heights_mm[-3:]
    assert above - grip == pytest.approx(60.0)
    assert up == above
    assert held.module.mass_kg == pytest.approx(0.25, abs=1e-3)
    # It lies 0.03 mm lower on its tray than drawn, so that much farther from the flange.
    assert held.module.top_over_flange_m == pytest.approx(-160.03 * MM, abs=2e-6)


async def test_another_mass_is_another_module(bench: Bench) -> None:
    bench.mass_kg = 0.28
    with pytest.raises(WrongModuleMass, match=r"0\.280 kg"):
        await picked(bench)
    assert bench.notes.figures[keys.MASS] == pytest.approx(0.28, abs=1e-3)


async def test_the_plan_brings_the_plug_onto_its_socket(bench: Bench) -> None:
    done = await planned(bench)
    target = done.plan.base_T_flange.pose * chain_plug(bench)
    off_m, off_rad = pose_error(bench.base_T_socket, target)
    assert np.linalg.norm(off_m[:2]) < 1e-6
    assert abs(off_rad[2]) < 1e-6
    assert bench.notes.figures[keys.WORST_CONTACT] < 0.05
    assert bench.notes.documents[keys.PLAN]["scheme"] == "difference"


async def test_every_look_at_the_socket_has_an_approach_of_its_own(bench: Bench) -> None:
    done = await planned(bench)
    looks = [event for event in bench.events if event.startswith("look socket")]
    assert looks == ["look socket-found", "look socket-1", "look socket-2"]
    over_socket = bench.visited[-4:]
    beside_mm = [(over_socket[n].translation - over_socket[n + 1].translation) / MM for n in (0, 2)]
    np.testing.assert_allclose(beside_mm, [[5, 0, 0], [-5, 0, 0]], atol=1e-9)
    assert len(done.looks.sockets) == 2
    assert bench.notes.figures[keys.SECOND_LOOKS] == 0


async def test_a_prediction_beyond_the_tolerance_is_refused(bench: Bench) -> None:
    with pytest.raises(PlugUncertain, match="largest term"):
        await planned(bench, worst_contact_mm=0.01)


async def test_a_plan_far_from_the_drawing_is_refused(bench: Bench) -> None:
    """However looks and correction add up: here the marks are 20 mm from where they are drawn."""
    with pytest.raises(PlanFarFromDrawing, match=r"\d\d\.\d+ mm and .* permitted are"):
        await planned(bench, flange_T_marks=(20.0, 0.0, 200.0, 0.0, 0.0, 0.0))


async def test_over_the_socket_by_the_free_way_and_tared_there(bench: Bench) -> None:
    done = await planned(bench)
    begun = len(bench.visited)
    await over.stand_off(done)
    seat_mm = done.plan.base_T_flange.pose.translation[2] / MM
    heights_mm = bench.heights_mm[begun:]
    stand_off_mm = seat_mm + bench.drawings.socket.seat_depth_m / MM + 3.0
    assert heights_mm[-1] == pytest.approx(stand_off_mm, abs=0.01)
    # Up where it is, across, and only then down.
    assert heights_mm[0] == heights_mm[1] == pytest.approx(stand_off_mm + 20.0, abs=0.01)
    np.testing.assert_allclose(
        bench.visited[begun].translation[:2], bench.visited[begun - 1].translation[:2]
    )
    assert bench.events[-2:] == ["slowly", "part?"]
    assert bench.guard.asked[-3:] == ["disarm", "set_wrench_frame", "tare"]


async def test_the_zero_over_the_socket_outlives_the_daemon(bench: Bench, tmp_path: Path) -> None:
    done = await planned(bench)
    arm = done.run.cell.arm
    arm.zero_file = tmp_path / "force.json"  # type: ignore[misc]
    bench.guard.serial = "M4347K-7"
    await over.stand_off(done)
    kept = await kept_zero(arm)
    assert kept is not None
    assert (kept.serial, kept.pressed) == ("M4347K-7", Pressed(inwards=-1.0, force_n=0.0))
    base_T_sensor = bench.visited[-1] * arm.flange_T_sensor
    outwards = base_T_sensor.rotation.apply(kept.pull_axis)
    np.testing.assert_allclose(outwards, [0.0, 0.0, 1.0], atol=0.02)


async def test_a_module_that_was_lost_on_the_way_is_told_before_any_contact(bench: Bench) -> None:
    done = await planned(bench)
    bench.guard.asked.clear()
    # Of 2.5 N, which is within what hoses may change.
    bench.lost, bench.mass_kg = True, 0.0
    bench.feel(sideways_n=0.0)
    with pytest.raises(PartLost):
        await over.stand_off(done)
    assert "arm" not in bench.guard.asked


async def test_a_plug_that_touches_already_is_not_tared_away(bench: Bench) -> None:
    done = await planned(bench)
    bench.feel(sideways_n=4.0)
    with pytest.raises(TareImplausible, match=r"4\.0 N"):
        await over.stand_off(done)
