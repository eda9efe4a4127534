"""A head whose robot was mastered anew: found by the first part, before anything is near it."""

import re

import pytest

from cellctl.packml.reject import RejectCode
from cellctl.records.store import RunStore
from tests.rigs.whole_cell.own_cell import OwnCell

pytestmark = pytest.mark.timeout(200)

TURNED_DEG = 0.04
"""Turn by which the head, two metres from its first axis, is 1.3 mm beside where it was."""

DRIFT_DEG = 0.012
"""What heads and bases have turned since they were calibrated, on the day of this seed, is seen
with it: 0.008° (``base_drift``, ``head_drift``)."""


@pytest.mark.figures  # half a minute; `test_part_pose.py`, `test_invalidation.py` find it too
def test_a_head_whose_robot_was_mastered_anew(own: OwnCell) -> None:
    own.fake().ready()
    own.daemon().ready()
    with own.control() as control:
        control.request("master", robot="aux_2", joint=1, deg=TURNED_DEG)
    assert own.plc("--serial", "MOVED").end(120) != 0
    with own.control() as control:
        assert control.request("truth")["truth"]["peak_contact_force_n"] == 0.0
    store = RunStore(own.data, create=False)
    try:
        fault = str(store.run(1).head.fault)
    finally:
        store.close()
    assert "F433" in fault
    moved = [float(number) for number in re.findall(r"[+-]\d+\.\d+", fault)]
    assert abs(moved[5]) == pytest.approx(TURNED_DEG, abs=DRIFT_DEG)
    # What rests on the heads is void: no further part is begun, by nobody.
    again = own.plc("--serial", "AGAIN")
    assert again.end(60) != 0
    assert again.messages[-1]["result"] == "rejected"
    assert again.messages[-1]["reject_code"] == RejectCode.CALIBRATION_INVALID
