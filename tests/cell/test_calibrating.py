"""Every calibration from nothing, as a line runs them on the fake cell."""

import pytest

from cellctl.calibration.store.store import CalibrationStore
from cellctl.clock import utc_now
from cellctl.processes.deck_to_frame.calibrations import CALIBRATIONS
from cellctl.runtime.jobs.factory import PLANNED
from fakes.demo.processes.deck_calibration import PROCEDURES
from tests.cell.rigs.own_cell import OwnCell

pytestmark = [pytest.mark.timeout(900), pytest.mark.long]


def test_all_procedures_in_their_order_open_the_gate(own: OwnCell) -> None:
    folder = own.folder / "calibration"
    own.change(str(own.calibration), str(folder))
    own.fake().ready()
    daemon = own.daemon()
    daemon.ready()
    with own.control() as control:
        for procedure in PROCEDURES:
            procedure.prepare(control)
            plc = own.plc("--mode", "maintenance", "--recipe", str(procedure.number))
            assert plc.end(400) == 0, (procedure.title, plc.stdout)
            assert plc.messages[-1]["result"] == "good", procedure.title
    calibrations = CalibrationStore(folder, CALIBRATIONS)
    assert calibrations.fault(CALIBRATIONS, PLANNED) is None
    kinds = [kind.for_recipe(1) for kind in CALIBRATIONS]
    found = calibrations.read_all(kinds, utc_now() + PLANNED)
    assert found.ids.keys() == {kind.name for kind in kinds}, "what commissioning measures too"
    assert [entry for entry in daemon.log if entry.get("event") == "fault"] == []
