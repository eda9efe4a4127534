"""A main arm that was mastered anew after its base frame was measured, on the whole fake cell."""

import pytest

from cellctl.packml.reject import RejectCode
from fakes.demo.processes.deck_calibration import PROCEDURES
from tests.rigs.whole_cell.own_cell import OwnCell

# The comparison has tests of its own.
pytestmark = [pytest.mark.timeout(300), pytest.mark.long]

TURNED_DEG = 0.03


def test_a_main_arm_that_was_mastered_anew(own: OwnCell) -> None:
    own.fake().ready()
    daemon = own.daemon()
    daemon.ready()
    base_frame = next(procedure for procedure in PROCEDURES if procedure.number == 103)
    with own.control() as control:
        base_frame.prepare(control, own.cell)
        # As a fresh cell is: with the reference that is shipped with its base frame.
        plc = own.plc("--mode", "maintenance", "--recipe", "109")
        assert plc.end(120) == 0, plc.stdout
        assert plc.messages[-1]["result"] == "good"
        control.request("master", robot="main", joint=1, deg=TURNED_DEG)
    moved = own.plc("--mode", "maintenance", "--recipe", "109")
    assert moved.end(120) != 0
    faults = [str(entry) for entry in daemon.log if entry.get("event") == "fault"]
    assert any("F319" in fault for fault in faults), faults
    again = own.plc("--serial", "AGAIN")
    assert again.end(60) != 0
    assert again.messages[-1]["reject_code"] == RejectCode.CALIBRATION_INVALID
