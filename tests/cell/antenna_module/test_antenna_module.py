"""Antenna modules on the fake cell, as `make demo-antenna` plugs them: daemon, line and all."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cellctl.processes.antenna_module.calibrations import TOOL_TURN
from cellctl.processes.antenna_module.faults.plugging import PlugBentPin
from cellctl.processes.antenna_module.record import keys
from cellctl.records import RunStore
from cellctl.records.entries import RunResult
from tests.rigs.whole_cell.own_cell import OwnCell
from tests.unit.records.conftest import start

pytestmark = [pytest.mark.timeout(400), pytest.mark.long]
PROCESS = ("--process", "antenna-module")


def result_of(out: Path) -> dict[str, Any]:
    result: dict[str, Any] = json.loads((out / "result.json").read_text(encoding="utf-8"))
    return result


def test_a_module_is_plugged(antenna: OwnCell) -> None:
    out = antenna.folder / "run"
    demo = antenna.demo(out, *PROCESS, "--seed", "2")
    assert demo.end(300) == 0, demo.stdout + demo.stderr
    demo.nobody_left()
    result = result_of(out)
    assert result["passed"]
    assert result["pins_inside"] == result["pins"] == 15
    assert result["met_offset_mm"] < 0.05
    assert result["peak_side_n"] < 3.0
    assert result["damaged"] == []
    page = (out / "report" / "report.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64") == 2
    drawings = re.findall(r"<figure>\s*<svg.*?</figure>", page, re.DOTALL)
    for caption in ("what the predicted error", "Force on the plug"):
        assert any(caption in drawing for drawing in drawings), f"no drawing {caption!r}"


@pytest.mark.parametrize(
    ("fault", "number", "place"),
    [
        ("world:empty_tray", "F580", "absent"),
        ("world:turned", "F581", "tray"),
        ("world:bent_pin", "F473", "tray"),
        ("world:missing_pin", "F472", "tray"),
        ("world:grip_off", "F586", "gripper"),
    ],
)
def test_a_module_that_cannot_be_plugged(
    antenna: OwnCell, fault: str, number: str, place: str
) -> None:
    out = antenna.folder / "run"
    demo = antenna.demo(out, *PROCESS, "--seed", "2", "--fault", fault)
    assert demo.end(300) == 2, demo.stdout + demo.stderr
    assert number in demo.stdout
    result = result_of(out)
    assert not result["passed"]
    assert result["module"] == place
    assert result["pins_inside"] == 0


def test_marks_that_have_moved_are_named_before_anything_is_picked(antenna: OwnCell) -> None:
    antenna.change("every_h = 87600.0", "every_h = 0.0")
    antenna.fake(seed=2).ready()
    daemon = antenna.daemon()
    daemon.ready()
    with antenna.control() as control:
        control.request("inject", device="world", name="marks_shifted", x_mm=0.03)
    plc = antenna.plc("--recipe", "1", "--serial", "MOD-0002")
    assert plc.end(300) != 0, plc.stdout
    assert [entry["number"] for entry in daemon.log if entry.get("event") == "fault"] == [647]
    (lost,) = (e for e in daemon.log if e.get("event") == "calibrations invalidated")
    assert lost["items"] == ["reference", "plug_correction_1"]


def test_a_module_that_was_gripped_badly_is_gripped_again_and_plugged(antenna: OwnCell) -> None:
    antenna.fake(seed=2).ready()
    daemon = antenna.daemon()
    daemon.ready()
    with antenna.control() as control:
        control.request("inject", device="world", name="grip_off", count=1, x_mm=2.5)
    plc = antenna.plc("--recipe", "1", "--serial", "MOD-0002")
    assert plc.end(300) == 0, plc.stdout
    assert '"step_number": 45' in plc.stdout
    with antenna.control() as control:
        assert control.request("truth")["truth"]["module"] == "socket"
    assert [entry for entry in daemon.log if entry.get("event") == "fault"] == []


def test_a_seat_that_comes_early_ends_with_the_module_out_of_its_socket(antenna: OwnCell) -> None:
    antenna.fake(seed=2).ready()
    daemon = antenna.daemon()
    daemon.ready()
    with antenna.control() as control:
        control.request("inject", device="world", name="foreign_body", early_mm=0.3)
        control.request("load")
    plc = antenna.plc("--recipe", "1", "--serial", "MOD-0002")
    assert plc.end(300) != 0, plc.stdout
    assert [entry["number"] for entry in daemon.log if entry.get("event") == "fault"] == [572]
    with antenna.control() as control:
        truth = control.request("truth")["truth"]
    # Backed out with sound pins, still in the gripper, which is the operator's to open.
    assert truth["module"] == "gripper"
    assert set(truth["pins"].values()) == {"outside"}
    assert truth["seated_depth_mm"] < 0.0
    store = RunStore(antenna.data, create=False)
    try:
        record = store.run(1)
    finally:
        store.close()
    assert record.head.result == RunResult.BAD
    assert [phase.number for phase in record.phases].count(80) == 1
    assert [one.name for one in record.artefacts].count(keys.CURVE) == 1


def test_a_module_that_has_met_a_force_fault_is_refused_when_it_comes_again(
    antenna: OwnCell,
) -> None:
    antenna.fake(seed=2).ready()
    store = RunStore(antenna.data)
    try:
        earlier = start(store, serial="MOD-0002", process="antenna-module")
        store.close_run(earlier, RunResult.BAD, fault_number=PlugBentPin.number)
    finally:
        store.close()
    daemon = antenna.daemon()
    daemon.ready()
    with antenna.control() as control:
        control.request("load")
    plc = antenna.plc("--recipe", "1", "--serial", "MOD-0002")
    assert plc.end(120) != 0, plc.stdout
    assert [entry["number"] for entry in daemon.log if entry.get("event") == "fault"] == [486]
    with antenna.control() as control:
        assert control.request("truth")["truth"]["module"] == "tray"


def test_the_marks_are_turned_over_camera_2_and_kept_as_a_calibration(antenna: OwnCell) -> None:
    antenna.fake(seed=2).ready()
    antenna.daemon().ready()
    plc = antenna.plc("--mode", "maintenance", "--recipe", "207")
    assert plc.end(300) == 0, plc.stdout
    stored = json.loads((antenna.calibration / "tool_turn.json").read_text(encoding="utf-8"))
    found = TOOL_TURN.result(stored["record"])
    with antenna.control() as control:
        true_mm = control.request("truth")["truth"]["flange_T_marks_mm_deg"][:2]
    # Eight looks of an arm with RP 0.02 mm are good to 2.3 µm per axis; but the turn is about the
    # last joint, which errors of the links put some hundredths of a millimetre beside the flange.
    assert np.linalg.norm(found.offset_m) * 1e3 == pytest.approx(np.hypot(*true_mm), abs=0.03)
    assert found.passed
    assert (antenna.calibration / "tool_turn.png").is_file()
