"""After a daemon that died in a run, the next start says where the arm stands and what it feels."""

import math
from pathlib import Path

import numpy as np
import pytest

from cellctl.errors.link import StaleData
from cellctl.errors.records import RecordNotWritten, RunInterrupted
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.packml.state import State
from cellctl.records.store import RunStore
from tests.unit.daemon_rig import DaemonRig


@pytest.fixture
async def died(rig: DaemonRig, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> DaemonRig:
    """A rig whose daemon died in contact, with 20 N; the unit is not open."""

    def lost(*_: object, **__: object) -> None:
        raise RecordNotWritten("the daemon was killed")

    rig.contact.may_end.clear()
    await rig.started()
    await rig.contact.reached.wait()
    with monkeypatch.context() as killed:
        killed.setattr(RunStore, "close_run", lost)
        killed.setattr(RunStore, "keep_end", lost)
        await rig.close()
    guard = rig.bench.cell.guard
    guard.raw = np.tile([0.0, 12.0, -16.0, 0.0, 0.0, 0.0], (50, 1))
    guard.asked.clear()
    guard.gravity_compensated = guard.in_part_frame = False
    return rig


async def test_line_alarms_and_record_say_where_the_arm_stands(died: DaemonRig) -> None:
    moves = len(died.bench.cell.main.moves)
    await died.open()
    status = died.shown()
    assert status.state is State.STOPPED
    assert RunInterrupted.number in status.alarms
    assert status.warning
    record = await died.record()
    assert record.head.result == "interrupted"
    text = next(one.text for one in record.alarms if one.number == RunInterrupted.number)
    x_mm, y_mm, z_mm = died.bench.cell.main.flange.translation * 1e3
    assert "run 1, step 50 mate" in text
    assert f"main at {x_mm:.1f} {y_mm:.1f} {z_mm:.1f} mm" in text
    assert "force: 20.0 N (Fx 0.0, Fy 12.0, Fz -16.0 N), without the payload's weight" in text
    assert len(died.bench.cell.main.moves) == moves
    await died.close()
    await died.open()
    alarms = (await died.record()).alarms
    assert [one.number for one in alarms].count(RunInterrupted.number) == 1, "said once"


async def test_what_is_not_known_is_said_and_the_cell_comes_up(died: DaemonRig) -> None:
    died.bench.cell.guard.faults["set_gravity_compensation"] = StaleData("guard")
    died.bench.cell.aux_1.faults["state"] = StaleData("2 s")
    await died.open()
    assert died.shown().state is State.STOPPED
    text = (await died.record()).alarms[-1].text
    assert "aux_1 unknown (F207" in text
    assert "payload included" in text


async def test_after_the_restart_the_force_has_the_sign_it_had_in_the_run(died: DaemonRig) -> None:
    guard, bench = died.bench.cell.guard, died.bench
    guard.sensor_T_wrench = None
    await died.open()
    assert guard.in_part_frame
    in_the_run = bench.deck.arm.flange_T_sensor.inv() * pose_from_xyzabc(bench.recipe.flange_T_deck)
    assert guard.sensor_T_wrench is not None
    np.testing.assert_allclose(guard.sensor_T_wrench.as_matrix(), in_the_run.as_matrix())


async def test_without_the_axes_of_the_part_no_component_has_a_sign(died: DaemonRig) -> None:
    guard = died.bench.cell.guard
    died.bench.cell.main.flange = died.bench.flange_over_seat(0.5)
    await died.open()
    assert not guard.in_part_frame, "no deck stands in a frame there"
    text = (await died.record()).alarms[-1].text
    assert "force: 20.0 N, without the payload's weight" in text
    assert "Fz" not in text
    assert math.isnan(died.shown().force_z_n)
