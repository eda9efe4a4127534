"""Every calibration from nothing, as `make demo-calibration` has a line run them."""

import json

import pytest

from cellctl.calibration.store.store import CalibrationStore
from cellctl.clock import utc_now
from cellctl.processes.deck_to_frame.calibrations import CALIBRATIONS
from cellctl.runtime.jobs.factory import PLANNED
from fakes.demo.processes.deck_calibration import PROCEDURES
from tests.rigs.whole_cell.own_cell import OwnCell

pytestmark = [pytest.mark.timeout(900), pytest.mark.long]


def test_all_procedures_in_their_order_open_the_gate(own: OwnCell) -> None:
    own.change(str(own.calibration), str(own.folder / "nothing-yet"))
    out = own.folder / "run"
    demo = own.demo(out, "--calibrate")
    assert demo.end(870) == 0, demo.stdout + demo.stderr
    demo.nobody_left()
    assert "images come through a GenTL producer" in demo.stdout
    for procedure in PROCEDURES:
        assert f"procedure {procedure.number}: {procedure.title}" in demo.stdout
    calibrations = CalibrationStore(out / "calibration", CALIBRATIONS)
    assert calibrations.fault(CALIBRATIONS, PLANNED) is None
    kinds = [kind.for_recipe(1) for kind in CALIBRATIONS]
    found = calibrations.read_all(kinds, utc_now() + PLANNED)
    assert found.ids.keys() == {kind.name for kind in kinds}, "what commissioning measures too"
    heads = (found.serial_numbers["head_1"], found.serial_numbers["head_2"])
    assert heads == ("FH-0001L+FH-0001R", "FH-0002L+FH-0002R"), "as the driver reads its cameras"
    log = (out / "daemon.log").read_text(encoding="utf-8").splitlines()
    entries = [json.loads(line) for line in log if line.startswith("{")]
    assert [entry for entry in entries if entry.get("event") == "fault"] == []
