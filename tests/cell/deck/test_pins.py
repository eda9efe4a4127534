"""A frame with dowel pins and a recipe that knows of them: one part, over the wire."""

import pytest

from cellctl.records.store import RunStore
from tests.rigs.whole_cell.own_cell import OwnCell

pytestmark = [pytest.mark.timeout(400), pytest.mark.long]

PINS = (
    "pins = { length_mm = 1.2, radius_mm = 3.0, clearance_mm = 0.02, chamfer_mm = 0.8, "
    "chamfer_deg = 45.0, stiffness_n_m = 2.0e7 }"
)


def test_a_part_is_mated_onto_its_pins(own: OwnCell) -> None:
    scenario = own.scenario.read_text(encoding="utf-8")
    place = "rim_inset_mm = 10.0\n"
    assert place in scenario
    own.scenario.write_text(scenario.replace(place, f"{place}{PINS}\n"), encoding="utf-8")
    cell = own.cell.read_text(encoding="utf-8")
    pins = "\n[recipes.mating.pins]\nengagement_mm = 1.4\n"
    own.cell.write_text(cell + pins, encoding="utf-8")
    own.fake().ready()
    own.daemon().ready()
    plc = own.plc("--serial", "PIN-1")
    assert plc.end(300) == 0, plc.stdout
    assert plc.messages[-1]["result"] == "good"
    with own.control() as control:
        truth = control.request("truth")["truth"]
    assert 35.0 <= truth["peak_contact_force_n"] < 50.0
    store = RunStore(own.data, create=False)
    try:
        record = store.run(1)
    finally:
        store.close()
    assert record.document("mating")["outcome"] == "seated"
    figures = record.newest_figures
    clear_mm, earliest_mm = (figures[f"window.{name}"].value for name in ("clear", "earliest"))
    assert clear_mm is not None
    assert earliest_mm is not None
    assert clear_mm < earliest_mm - 1.4
    gave_way_mm = [record.value(f"gave_way.{axis}") or 0.0 for axis in "xy"]
    assert sum(map(abs, gave_way_mm)) < 0.1
