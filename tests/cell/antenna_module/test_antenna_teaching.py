"""Procedure 206 over the whole fake antenna cell: an operator plugs by hand, the cell learns."""

import json

import numpy as np
import pytest

from cellctl.geometry.pose import MM, pose_error
from cellctl.processes.antenna_module.calibrations import PLUG_CORRECTION
from cellctl.processes.antenna_module.chain.teaching.taught import PlugCorrection
from cellctl.processes.antenna_module.procedures.teach_plug import MODE
from cellctl.processes.antenna_module.record import keys
from cellctl.records import RunStore
from cellctl.records.entries import RunRecord, RunResult
from tests.rigs.whole_cell.own_cell import OwnCell

TAUGHT, CHECKED = 4, 1
_A_PLUG_S = 200
"""Found, picked, seen from both cameras and plugged by hand; images take most of it, and most of
all on a PC that does other things, too."""
pytestmark = [pytest.mark.timeout((TAUGHT + CHECKED + 2) * _A_PLUG_S), pytest.mark.long]
KIND = PLUG_CORRECTION.for_recipe(1)
MICRO_D, D_SUB = "micro-d-15", "d-sub-15"


def _correction(own: OwnCell) -> PlugCorrection:
    stored = (own.calibration / f"{KIND.name}.json").read_text(encoding="utf-8")
    return PlugCorrection.from_record(json.loads(stored)["record"])


def _teach(own: OwnCell, seed: int) -> None:
    """Fake cell and daemon run; an operator plugs until the correction is stored."""
    own.change("views = 30", f"views = 30\ntaught_plugs = {TAUGHT}\nchecked_plugs = {CHECKED}")
    own.fake(seed).ready()
    daemon = own.daemon()
    daemon.ready()
    with own.control() as control:
        control.request("load")
        control.request("stand_by", on=True)
    wait_s = (TAUGHT + CHECKED) * _A_PLUG_S
    plc = own.plc("--mode", "maintenance", "--recipe", "20601", "--timeout", str(wait_s))
    assert plc.end(wait_s + 30) == 0, plc.stdout + plc.stderr
    assert [entry for entry in daemon.log if entry.get("event") == "fault"] == []


def _record(own: OwnCell, number: int) -> RunRecord:
    store = RunStore(own.data, create=False)
    try:
        return store.run(number)
    finally:
        store.close()


def test_a_correction_is_taught_checked_and_stored_and_agrees_with_the_shipped_one(
    antenna: OwnCell,
) -> None:
    shipped = _correction(antenna)
    _teach(antenna, seed=5)
    taught = _correction(antenna)
    assert taught.passed
    (slot,) = taught.slots
    assert slot.plugs == TAUGHT
    checked = [check.name for check in taught.checks if check.name.startswith("checked plug 1")]
    assert checked == ["checked plug 1: offset", "checked plug 1: yaw"]
    # The same devices, other plugs: the mean of four and the mean of eight are apart by what the
    # arm repeats, 8 µm per axis.
    assert taught.made_with == shipped.made_with
    offset_m, turn_rad = pose_error(shipped.slots[0].socket_T_plug.pose, slot.socket_T_plug.pose)
    assert np.linalg.norm(offset_m[:2]) < 0.04 * MM
    assert abs(np.degrees(turn_rad[2])) < 0.05
    record = _record(antenna, 1)
    assert (record.head.mode, record.head.result) == (MODE, RunResult.GOOD)
    assert (record.head.process, record.head.recipe_id) == ("antenna-module", 1)
    assert record.head.calibration_ids.keys() >= {"camera_1", "flange_T_cam1", "base_T_cam2"}
    assert keys.TAUGHT_PICTURE in [one.name for one in record.artefacts]


def test_a_d_sub_is_taught_and_then_plugged_with_what_was_taught(antenna: OwnCell) -> None:
    (antenna.calibration / f"{KIND.name}.json").unlink()
    scenario = antenna.scenario.read_text(encoding="utf-8")
    assert MICRO_D in scenario
    antenna.scenario.write_text(scenario.replace(MICRO_D, D_SUB), encoding="utf-8")
    antenna.change(MICRO_D, D_SUB)
    _teach(antenna, seed=6)
    assert _correction(antenna).made_with.connector == f"{D_SUB} in {D_SUB}"
    with antenna.control() as control:
        control.request("stand_by", on=False)
        control.request("load")
    plc = antenna.plc("--recipe", "1", "--serial", "MOD-0006")
    assert plc.end(300) == 0, plc.stdout
    with antenna.control() as control:
        truth = control.request("truth")["truth"]
    assert truth["module"] == "socket"
    assert set(truth["pins"].values()) == {"inside"}
    assert truth["met_offset_at_worst_contact_mm"] < 0.05
    assert max(truth["peak_side_n"].values()) < 3.0
    plan = _record(antenna, 2).document(keys.PLAN)
    assert plan["p99_um"] <= 50.0
