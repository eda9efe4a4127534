"""Procedures 107 and 108 as a line runs them: over Modbus, on the fake cell, with contact."""

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from cellctl.records.store import RunStore
from tests.rigs.whole_cell.own_cell import ROOT, OwnCell

pytestmark = [pytest.mark.timeout(600), pytest.mark.long]

SHIPPED = ROOT / "config" / "demo-calibration"
BY_PRODUCTION = ("head_1", "head_2", "base_frame", "board_transfer", "payload")


def test_latency_and_stiffness_are_measured_and_used(own: OwnCell) -> None:
    folder = own.folder / "calibration"
    folder.mkdir()
    for kind in BY_PRODUCTION:
        shutil.copy(SHIPPED / f"{kind}.json", folder)
    own.change(str(own.calibration), str(folder))
    own.fake().ready()
    daemon = own.daemon()
    daemon.ready()
    with own.control() as control:
        control.request("present", frame=False, deck=True)
        _run(own, 107)
        control.request("present", frame=True, deck=True)
        before_n = control.request("truth")["truth"]["peak_contact_force_n"]
        _run(own, 108)
        truth = control.request("truth")["truth"]
    assert before_n == 0.0
    assert 35.0 <= truth["peak_contact_force_n"] < 50.0
    _latency_is_true(folder)
    record = _stiffness_is_plausible(folder)
    _everything_is_on_record(own.data, record["run"])
    parts = [entry for entry in daemon.log if entry.get("event") == "fault"]
    assert parts == []


def _run(own: OwnCell, procedure: int) -> None:
    plc = own.plc("--mode", "maintenance", "--recipe", str(procedure))
    assert plc.end(400) == 0, plc.stdout
    assert plc.messages[-1]["result"] == "good"


def _read(folder: Path, kind: str) -> dict[str, Any]:
    record: dict[str, Any] = json.loads((folder / f"{kind}.json").read_text())["record"]
    assert record["verdict"] == "pass"
    assert (folder / f"{kind}.png").stat().st_size > 10_000
    return record


def _latency_is_true(folder: Path) -> None:
    record = _read(folder, "stop_latency")
    assert record["latency_ms"] == pytest.approx(250.0, abs=15.0)
    assert record["latency_ms"] < record["upper_ms"] <= 300.0


def _stiffness_is_plausible(folder: Path) -> dict[str, Any]:
    """The contact is 1e6 to 3e6 N/m, the arm 1e6 N/m: 500 to 750 N/mm together, less on an edge."""
    record = _read(folder, "contact_stiffness_1")
    assert 300.0 < record["stiffness_n_per_mm"] < 850.0
    assert record["stiffness_n_per_mm"] < record["upper_n_per_mm"]
    assert len(record["contacts"]) == 3
    assert all(contact["peak_force_n"] < 50.0 for contact in record["contacts"])
    return record


def _everything_is_on_record(data: Path, run: int) -> None:
    store = RunStore(data, create=False)
    try:
        found = store.run(run)
        kinds = {stored.kind for stored in store.calibrations()}
    finally:
        store.close()
    assert (found.head.mode, found.head.result) == ("commissioning", "good")
    curves = [artefact.name for artefact in found.artefacts if artefact.name.startswith("force")]
    assert curves == ["force-1.mcap", "force-2.mcap", "force-3.mcap"]
    assert found.value("approach.stop_latency") == pytest.approx(0.3)
    assert {"stop_latency", "contact_stiffness_1"} <= kinds
