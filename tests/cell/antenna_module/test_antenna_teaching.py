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
from cellctl.records.entries import RunResult
from tests.rigs.whole_cell.own_cell import OwnCell

TAUGHT, CHECKED = 4, 1
_A_PLUG_S = 200
"""Found, picked, seen from both cameras and plugged by hand; images take most of it, and most of
all on a PC that does other things, too."""
pytestmark = [pytest.mark.timeout((TAUGHT + CHECKED + 1) * _A_PLUG_S), pytest.mark.long]
KIND = PLUG_CORRECTION.for_recipe(1)


def _correction(own: OwnCell) -> PlugCorrection:
    stored = (own.calibration / f"{KIND.name}.json").read_text(encoding="utf-8")
    return PlugCorrection.from_record(json.loads(stored)["record"])


def test_a_correction_is_taught_checked_and_stored_and_agrees_with_the_shipped_one(
    antenna: OwnCell,
) -> None:
    shipped = _correction(antenna)
    antenna.change("views = 30", f"views = 30\ntaught_plugs = {TAUGHT}\nchecked_plugs = {CHECKED}")
    antenna.fake(seed=5).ready()
    daemon = antenna.daemon()
    daemon.ready()
    with antenna.control() as control:
        control.request("load")
        control.request("stand_by", on=True)
    wait_s = (TAUGHT + CHECKED) * _A_PLUG_S
    plc = antenna.plc("--mode", "maintenance", "--recipe", "20601", "--timeout", str(wait_s))
    assert plc.end(wait_s + 30) == 0, plc.stdout + plc.stderr
    assert [entry for entry in daemon.log if entry.get("event") == "fault"] == []
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
    store = RunStore(antenna.data, create=False)
    try:
        record = store.run(1)
    finally:
        store.close()
    assert (record.head.mode, record.head.result) == (MODE, RunResult.GOOD)
    assert keys.TAUGHT_PICTURE in [one.name for one in record.artefacts]
